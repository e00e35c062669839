"""Who walks in a world: what a user asks for, and what files say, before there is a world."""

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from harness.base.errors import UsageError
from harness.spec.actor import NAME, SUFFIXES, ActorOptions, ActorSpec
from harness.world.actors.trajectory import Trajectory, actors_of, read_trajectories

MOST_ACTORS = 100


@dataclass(frozen=True)
class Pedestrian:
    """One person, before there is a world.

    Attributes:
        text: What asks for the person, for messages.
        name: Of the topic: /NAME_actor/pose.
        options: Speed, size and the like.
        trajectory: The way points of the walk; None if a walker chooses its own.
        walker: "random" or "social"; "" if there is a trajectory.
    """

    text: str
    name: str
    options: ActorOptions
    trajectory: Trajectory | None = None
    walker: str = ""

    @property
    def full_name(self) -> str:
        """Name of the body, and of the topic before /pose."""
        return f"{self.name}_actor"


def pedestrians(specs: Sequence[ActorSpec], folders: Sequence[str] = ()) -> tuple[Pedestrian, ...]:
    """Returns the people that are asked for; files are read.

    Args:
        specs: One or more people each.
        folders: In which what files include is looked for first.

    Raises:
        UsageError: A file is not valid, or two people have one name.
    """
    people = [person for spec in specs for person in _people_of(spec, tuple(folders))]
    names = [person.name for person in people]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise UsageError(
            f"two actors are called '{twice}'; give one another name, as in guide=FILE.sdf, or by a "
            "<name> in its <include>"
        )
    if len(people) > MOST_ACTORS:
        raise UsageError(f"{len(people)} actors are too many; give at most {MOST_ACTORS}")
    return tuple(people)


def of_terrain(terrain: str, folders: Sequence[str] = ()) -> tuple[ActorSpec, ...]:
    """Returns what asks for the people of a terrain: of an SDF world with actors, else nothing.

    Args:
        terrain: Its name, or its file.
        folders: In which what it includes is looked for first.
    """
    path = Path(terrain)
    if not terrain.lower().endswith(SUFFIXES) or not path.is_file():
        return ()
    with suppress(UsageError):  # the world reports it, whose mistake it is
        return (
            (ActorSpec(terrain, "", ActorOptions(), file=terrain),)
            if actors_of(path, tuple(folders))
            else ()
        )
    return ()


def _people_of(spec: ActorSpec, folders: tuple[str, ...]) -> tuple[Pedestrian, ...]:
    text, name, options = spec.text, spec.name, spec.options
    if spec.walker:
        return (Pedestrian(text, _checked(text, name), options, walker=spec.walker),)
    if spec.points:
        return (Pedestrian(text, _checked(text, name), options, Trajectory(name, spec.points)),)
    trajectories = read_trajectories(Path(spec.file), folders)
    if name and len(trajectories) > 1:
        raise UsageError(
            f"actor '{text}': {spec.file} has {len(trajectories)} actors with names; leave out '{name}='"
        )
    return tuple(
        Pedestrian(text, _checked(text, name or re.sub(r"\W", "_", one.name)), options, one)
        for one in trajectories
    )


def _checked(text: str, name: str) -> str:
    short = name.removesuffix("_actor")
    if not NAME.fullmatch(short):
        raise UsageError(
            f"actor '{text}': '{name}' cannot be part of a topic's name; begin with a letter, "
            "go on with letters, digits and _, as in guide=FILE.sdf"
        )
    return short
