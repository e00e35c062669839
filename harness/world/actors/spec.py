"""`--actor` as text -> what it asks for.

NAME=X,Y/X,Y/...   way points        FILE.sdf or NAME=FILE.sdf   a trajectory, or the actors of a world
NAME=random        a random walker   NAME=social                 one who keeps out of others' way
each with :KEY=VALUE,... behind it
"""

import math
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from harness.base.errors import UsageError, unknown
from harness.world.actors.trajectory import SUFFIXES, Told, actors_of, read_told

FORM = "give [NAME=]FILE.sdf, NAME=X,Y/X,Y/..., NAME=random or NAME=social, and :KEY=VALUE,... behind it"
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
POINTS = re.compile(rf"{NUMBER},{NUMBER}(?:/{NUMBER},{NUMBER})*")
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
BEHIND = re.compile(r"(?P<what>.*?)(?::(?P<options>\w+=[^:/\\]*))?", re.DOTALL)
WALKERS = ("random", "social")
ROUTES = ("mirror", "closed")
MOST_ACTORS = 100
SLOWEST, FASTEST = 0.05, 10.0  # [m/s]


@dataclass(frozen=True)
class Options:
    """What can be said of a person.

    Attributes:
        speed: [m/s].
        route: Of way points: there and back (mirror), or round (closed).
        delay: Before the walk begins [s].
        radius: Of the body, a capsule [m]; likewise its height.
        within: Of walkers: how far from the rover's start they walk [m].
        push: 1 if the rover and they are solid to each other; else it drives through them, as in Gazebo.
    """

    speed: float = 1.0
    route: str = "mirror"
    delay: float = 0.0
    radius: float = 0.25
    height: float = 1.75
    within: float = 8.0
    push: int = 0


LIMITS = {
    "speed": (SLOWEST, FASTEST),
    "delay": (0.0, 1e6),
    "radius": (0.05, 1.0),
    "height": (0.3, 3.0),
    "within": (2.0, 500.0),
    "push": (0, 1),
}


@dataclass(frozen=True)
class ActorSpec:
    """One person, before there is a world.

    Attributes:
        text: As it was given, for messages.
        name: Of its topic: /NAME_actor/pose.
        told: Its way, of way points; None of a walker.
        walker: One of WALKERS; "" of way points.
    """

    text: str
    name: str
    options: Options
    told: Told | None = None
    walker: str = ""

    @property
    def full_name(self) -> str:
        """Name of the body, and of the topic before /pose."""
        return f"{self.name}_actor"


def parse_actors(texts: Sequence[str], folders: Sequence[str] = ()) -> tuple[ActorSpec, ...]:
    """Returns the people that the words ask for; files are read.

    Args:
        texts: One or more people each.
        folders: In which what files include is looked for first.

    Raises:
        UsageError: A word is not valid, or two people have one name.
    """
    people = [spec for text in texts for spec in _parse(text, tuple(folders))]
    names = [spec.name for spec in people]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise UsageError(
            f"two actors are called '{twice}'; give one another name, as in guide=FILE.sdf, or by a "
            "<name> in its <include>"
        )
    if len(people) > MOST_ACTORS:
        raise UsageError(f"{len(people)} actors are too many; give at most {MOST_ACTORS}")
    return tuple(people)


def of_terrain(terrain: str, folders: Sequence[str] = ()) -> tuple[str, ...]:
    """Returns the words that ask for the people of a terrain: of an SDF world with actors, else none.

    Args:
        terrain: Its name, or its file.
        folders: In which what it includes is looked for first.
    """
    path = Path(terrain)
    if not terrain.lower().endswith(SUFFIXES) or not path.is_file():
        return ()
    with suppress(UsageError):  # which the world tells, whose mistake it is
        return (terrain,) if actors_of(path, tuple(folders)) else ()
    return ()


def beside(text: str, place: Callable[[str], Path]) -> str:
    """Returns a spec whose file, if it names one, is where `place` finds it."""
    name, what, behind = _split(text)
    named, options = name and f"{name}=", behind and f":{behind}"
    return f"{named}{place(what)}{options}" if what.lower().endswith(SUFFIXES) else text


def _split(text: str) -> tuple[str, str, str]:
    """Its name, what walks, and its options; "" for what is not there."""
    found = BEHIND.fullmatch(text)
    what, behind = (found["what"], found["options"] or "") if found else (text, "")
    name, sign, rest = what.partition("=")
    return (name, rest, behind) if sign and NAME.fullmatch(name) else ("", what, behind)


def _parse(text: str, folders: tuple[str, ...]) -> tuple[ActorSpec, ...]:
    name, what, behind = _split(text)
    options = _options(text, behind)
    if what in WALKERS:
        return (ActorSpec(text, _checked(text, name or what), options, walker=what),)
    if POINTS.fullmatch(what):
        if not name:
            raise UsageError(f"actor '{text}' has no name; {FORM}")
        points = tuple(tuple(map(float, point.split(","))) for point in what.split("/"))
        return (ActorSpec(text, _checked(text, name), options, Told(name, points)),)
    if not what.lower().endswith(SUFFIXES):
        raise UsageError(f"actor '{text}' is not valid; {FORM}")
    path = Path(what)
    people = read_told(path, folders)
    if name and len(people) > 1:
        raise UsageError(
            f"actor '{text}': {path} has {len(people)} actors with names; leave out '{name}='"
        )
    called = [name or re.sub(r"\W", "_", told.name) for told in people]
    return tuple(
        ActorSpec(text, _checked(text, one), options, told)
        for one, told in zip(called, people, strict=True)
    )


def _checked(text: str, name: str) -> str:
    short = name.removesuffix("_actor")
    if not NAME.fullmatch(short):
        raise UsageError(
            f"actor '{text}': '{name}' cannot be part of a topic's name; begin with a letter, "
            "go on with letters, digits and _, as in guide=FILE.sdf"
        )
    return short


def _options(text: str, behind: str) -> Options:
    values: dict[str, Any] = {}
    names = [item.name for item in fields(Options)]
    for pair in behind.split(",") if behind else ():
        key, _, value = pair.partition("=")
        if key not in names:
            raise UsageError(f"actor '{text}': {unknown('key', key, names)}")
        values[key] = _value(text, key, value)
    options = Options(**values)
    if options.height < 2 * options.radius:
        raise UsageError(f"actor '{text}': a body is at least as high as wide; give a smaller radius")
    return options


def _value(text: str, key: str, value: str) -> str | float:
    if key == "route":
        if value not in ROUTES:
            raise UsageError(f"actor '{text}': {unknown('route', value, ROUTES)}")
        return value
    low, high = LIMITS[key]
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not low <= number <= high or (key == "push" and number not in (0, 1)):
        raise UsageError(f"actor '{text}': {key} '{value}' is not valid; give {low:g} to {high:g}")
    return number
