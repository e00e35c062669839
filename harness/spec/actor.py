"""A person who walks, as a user writes it.

NAME=X,Y/X,Y/...   way points        FILE.sdf or NAME=FILE.sdf   a trajectory, or the actors of a world
NAME=random        a random walker   NAME=social                 one who keeps out of others' way
each with :KEY=VALUE,... behind it

Files are read by harness.world.actors.
"""

import re
from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from harness.base.errors import UsageError
from harness.spec.target import NAME
from harness.spec.value import AsText, Value, made, parsed, words_of
from rover_metrics import number

FORM = "give [NAME=]FILE.sdf, NAME=X,Y/X,Y/..., NAME=random or NAME=social, and :KEY=VALUE,... behind it"
POINTS = re.compile(rf"{number.FORM},{number.FORM}(?:/{number.FORM},{number.FORM})*")
BEHIND = re.compile(r"(?P<way>.*?)(?::(?P<options>\w+=[^:/\\]*))?", re.DOTALL)
WALKERS = ("random", "social")
SUFFIXES = (".sdf", ".world", ".xml")  # of files with trajectories


class ActorOptions(Value):
    """What can be said of a person.

    Attributes:
        speed: [m/s].
        route: Of way points: there and back (mirror), or round (closed).
        delay: Before the walk begins [s].
        radius: Of the body, a capsule [m].
        height: Of the body [m]; more than twice the radius.
        within: Of walkers: how far from the rover's start they walk [m].
        push: 1 if the rover and they are solid to each other; else it drives through them, as in Gazebo.
    """

    speed: Annotated[float, Field(ge=0.05, le=10.0)] = 1.0
    route: Literal["mirror", "closed"] = "mirror"
    delay: Annotated[float, Field(ge=0.0, le=1e6)] = 0.0
    radius: Annotated[float, Field(ge=0.05, le=1.0)] = 0.25
    height: Annotated[float, Field(ge=0.3, le=3.0)] = 1.75
    within: Annotated[float, Field(ge=2.0, le=500.0)] = 8.0
    push: Annotated[int, Field(ge=0, le=1)] = 0

    @model_validator(mode="after")
    def _has_the_shape_of_a_capsule(self) -> Self:
        if self.height <= 2 * self.radius:
            raise ValueError("a body is higher than wide; give a smaller radius")
        return self


@dataclass(frozen=True)
class ActorSpec:
    """People as one text asks for them.

    Attributes:
        text: As it was given, for messages.
        name: As given; "" if the file names them.
        options: What else is said of them.
        points: Way points, x and y in the world [m]; empty without any.
        file: That holds their trajectories; "" without one.
        walker: One of WALKERS; "" of way points and files.
    """

    text: str
    name: str
    options: ActorOptions
    points: tuple[tuple[float, float], ...] = ()
    file: str = ""
    walker: str = ""

    def __str__(self) -> str:
        """Returns the text that it was read from."""
        return self.text

    def in_file(self, file: str) -> Self:
        """Returns the same people, read from another file."""
        named = f"{self.name}=" if self.name else ""
        behind = self.text.removeprefix(f"{named}{self.file}")
        return type(self)(f"{named}{file}{behind}", self.name, self.options, file=file)


def parse_actor(text: str) -> ActorSpec:
    """Returns the people that a text asks for; UsageError names what would be valid."""
    match = BEHIND.fullmatch(text)
    way, behind = (match["way"], match["options"] or "") if match else (text, "")
    name, sign, rest = way.partition("=")
    name, way = (name, rest) if sign and NAME.fullmatch(name) else ("", way)
    options = made(ActorOptions, words_of(behind), f"actor '{text}'")
    if way in WALKERS:
        return ActorSpec(text, name or way, options, walker=way)
    if POINTS.fullmatch(way):
        if not name:
            raise UsageError(f"actor '{text}' has no name; {FORM}")
        x_y = (point.split(",") for point in way.split("/"))
        return ActorSpec(text, name, options, points=tuple((float(x), float(y)) for x, y in x_y))
    if not way.lower().endswith(SUFFIXES):
        raise UsageError(f"actor '{text}' is not valid; {FORM}")
    return ActorSpec(text, name, options, file=way)


ActorText = Annotated[ActorSpec, parsed(parse_actor), AsText]
