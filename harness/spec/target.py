"""Something to be found in a world, as a user writes it: [NAME=]KIND[:KEY=VALUE,...].

KIND may be a FILE.obj. Without a place it stands at a free one, which the seed draws. What the kinds
look like is known to harness.world.targets.
"""

import re
from dataclasses import dataclass, replace
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from harness.base.errors import UsageError, unknown
from harness.spec.value import AsText, Finite, Latitude, Length, Longitude, Value, made, parsed, words_of

FORM = "[NAME=]KIND[:KEY=VALUE,...]"
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
TEXT = re.compile(r"(?:(?P<name>[^=:]*)=)?(?P<kind>.+?)(?::(?P<options>\w+=.*))?", re.DOTALL)
MESH = ".obj"
DICTIONARIES = {  # of OpenCV: how many of its first ids are valid, and cells along a side of the code
    **{f"{n}x{n}_{count}": (count, n) for n in (4, 5, 6, 7) for count in (50, 100, 250, 1000)},
    "apriltag_36h11": (587, 6),
    "original": (1024, 5),
}
PLACE = ("x", "y", "lat", "lon", "yaw", "within", "reach")
MARKER = ("dictionary", "id", "size", "height", "faces")
# Which keys each kind has beside those of its place.
KINDS: dict[str, tuple[str, ...]] = {
    "aruco": MARKER,
    "post": ("height", "radius"),
    "gate": (*MARKER, "width"),
    "mallet": (),
    "bottle": (),
    MESH: ("texture", "scale", "up"),
}


class TargetOptions(Value):
    """What can be said of a target; which keys a kind has stands in KINDS.

    Attributes:
        x, y: Where it stands in the world [m].
        lat, lon: The same in degrees on WGS-84, about the world's datum.
        yaw: Heading of its first face, of a gate its way through [rad]; towards the start if left out.
        within: Farthest from the rover's start that a free place is drawn [m].
        reach: How near a stop must be to have found it [m]; 2 m in URC 2023.
        dictionary: Of OpenCV's ArUco, one of DICTIONARIES.
        id: Of the marker; a gate's left post has it, seen from the start, its right one the next.
        size: Edge of a marker's black square [m]: 15 cm in URC 2023, on faces of 20 cm.
        height: Of the middle of the faces above the ground; of a plain post its own [m].
        faces: How many sides of a post carry the marker; 0 for a pole without any.
        width: Between a gate's posts [m]; 2 m in URC 2023.
        radius: Of a plain post [m].
        texture: Picture of a mesh with texture coordinates, in an image file; "" for one grey.
        scale: Length of a mesh's unit [m].
        up: Axis of a mesh that is up.
    """

    x: Finite | None = None
    y: Finite | None = None
    lat: Latitude | None = None
    lon: Longitude | None = None
    yaw: Finite | None = None
    within: Annotated[float, Field(ge=3.0, le=500.0)] = 8.0
    reach: Length = 2.0
    dictionary: str = "4x4_50"
    id: Annotated[int, Field(ge=0)] = 0
    size: Annotated[float, Field(ge=0.02, le=2.0)] = 0.15
    height: Annotated[float, Field(ge=0.05, le=10.0)] = 1.0
    faces: Annotated[int, Field(ge=0, le=4)] = 3
    width: Annotated[float, Field(ge=0.5, le=20.0)] = 2.0
    radius: Annotated[float, Field(ge=0.01, le=1.0)] = 0.05
    texture: str = ""
    scale: Annotated[float, Field(ge=1e-4, le=1e3)] = 1.0
    up: Literal["z", "y", "x"] = "z"

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        for one, other in (("x", "y"), ("lat", "lon")):
            if (getattr(self, one) is None) != (getattr(self, other) is None):
                raise ValueError(f"a place needs {one} and {other}; give both, or neither")
        if self.x is not None and self.lat is not None:
            raise ValueError("give a place as x and y or as lat and lon, not as both")
        if self.dictionary not in DICTIONARIES:
            raise ValueError(unknown("dictionary", self.dictionary, DICTIONARIES))
        if self.id >= (count := DICTIONARIES[self.dictionary][0]):
            raise ValueError(f"id {self.id} is not in {self.dictionary}; give 0 to {count - 1}")
        return self


@dataclass(frozen=True)
class TargetSpec:
    """A target as a text asks for it.

    Attributes:
        text: As it was given.
        name: As given; "" for that of its kind, with a number among several.
        kind: A key of KINDS.
        options: What else is said of it.
        file: Of a mesh; else "".
    """

    text: str
    name: str
    kind: str
    options: TargetOptions
    file: str = ""

    def __str__(self) -> str:
        """Returns the text that it was read from."""
        return self.text

    @property
    def files(self) -> tuple[str, str]:
        """Its mesh and the picture on it; "" without one."""
        return self.file, self.options.texture

    def in_file(self, file: str, texture: str) -> Self:
        """Returns the same target with its mesh and texture in other files."""
        options = self.options.but(texture=texture)
        text = self.text.replace(self.file, file, 1) if self.file else self.text
        text = text.replace(f"texture={self.options.texture}", f"texture={texture}") if texture else text
        return replace(self, text=text, file=file, options=options)


def parse_target(text: str) -> TargetSpec:
    """Returns the target that a text asks for; UsageError names what would be valid."""
    match = TEXT.fullmatch(text)
    if match is None:
        raise UsageError(f"target '{text}' is not valid; give {FORM}, e.g. aruco:id=3,x=5,y=2")
    name, word = match["name"], match["kind"]
    if name is not None and not NAME.fullmatch(name):
        raise UsageError(f"target '{text}': the name '{name}' is not valid; give letters, digits and _")
    is_mesh = word.lower().endswith(MESH)
    kind = MESH if is_mesh else word
    if kind not in KINDS or word == MESH:
        raise UsageError(f"target '{text}': {unknown('kind', word, [*KINDS][:-1])}, or a FILE{MESH}")
    given = words_of(match["options"] or "", (*PLACE, *KINDS[kind]), f"target '{text}': ")
    options = made(TargetOptions, given, f"target '{text}'")
    if kind == "gate" and options.faces and options.id + 1 >= DICTIONARIES[options.dictionary][0]:
        raise UsageError(f"target '{text}': a gate needs two ids; give a smaller one than {options.id}")
    return TargetSpec(text, name or "", kind, options, word if is_mesh else "")


TargetText = Annotated[TargetSpec, parsed(parse_target), AsText]
