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
    """One person, before there is a world."""

    text: str  # what asks for the person, for messages
    name: str  # of the topic: /NAME_actor/pose
    options: ActorOptions  # speed, size and the like
    trajectory: Trajectory | None = None  # the way points of the walk; None if a walker chooses its own
    walker: str = ""  # "random" or "social"; "" if there is a trajectory

    @property
    def full_name(self) -> str:
        """Name of the body, and of the topic before /pose."""
        return f"{self.name}_actor"


def pedestrians(specs: Sequence[ActorSpec], folders: Sequence[str] = ()) -> tuple[Pedestrian, ...]:
    """Returns the people that are asked for; UsageError if a file is not valid or a name is there twice.

    What files include is looked for in the folders first.
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
    """Returns what asks for the people of a terrain: of an SDF world with actors, else nothing."""
    path = Path(terrain)
    if not terrain.lower().endswith(SUFFIXES) or not path.is_file():
        return ()
    with suppress(UsageError):  # the world reports it, whose mistake it is
        if actors_of(path, tuple(folders)):
            return (ActorSpec(terrain, "", ActorOptions(), file=terrain),)
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
