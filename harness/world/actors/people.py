"""Who walks in a world, before there is one: what a user asks for; trajectory files, actors of SDF."""

import re
import unicodedata
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from harness.base.errors import UsageError, repeated
from harness.base.made_of_files import Files, made_of_files
from harness.base.sdf.poses import read_pose
from harness.base.sdf.reader import is_true, numbers, text_of
from harness.base.sdf.resources import Resources
from harness.base.xml import read_xml
from harness.spec.actor import SUFFIXES, ActorOptions, ActorSpec
from harness.spec.target import NAME
from harness.world.actors.route import LONGEST_ROUTE, Point
from harness.world.sdf.document import Document, Person
from harness.world.sdf.reading import read_document

MOST_ACTORS = 100


# RoboTerrain names its files for the world too: inspect_diag.sdf is of /diag_actor/pose.
AROUND = re.compile(r"^(?:inspect|construct|island|moon|flat)_|_traject(?:ory)?(?=_|$)")


@dataclass(frozen=True)
class Trajectory:
    """The way points of one person, as a file has them."""

    name: str
    points: tuple[Point, ...]  # x, y, z of the way points in the world [m]
    # of an SDF actor's way points [s]; empty in a trajectory alone, where times do not count
    times: tuple[float, ...] = ()
    loops: bool = True  # whether the script begins anew at its end
    delay: float = 0.0  # before it begins [s]


@made_of_files(32)  # asked several times a run, as are documents
def read_trajectories(path: Path, folders: tuple[str, ...] = ()) -> tuple[tuple[Trajectory, ...], Files]:
    """Returns the people of a file: the one whose trajectory it is, or its actors; else UsageError.

    What it includes is looked for in the folders first.
    """
    root = read_xml(path)
    if root.tag == "trajectory":
        points, _ = _way_points(root, path)
        return (Trajectory(AROUND.sub("", path.stem), points),), [path]
    if root.tag == "actor":
        pose, _ = read_pose(root, name := root.get("name", "actor"))
        return (_scripted(Person(name, root, pose, path)),), [path]
    document = _document(path, folders)
    if not document.actors:
        raise UsageError(f"{path} has neither a <trajectory> nor an <actor>; name a file with one")
    return tuple(map(_scripted, document.actors)), document.files


@made_of_files(8)
def _document(path: Path, folders: tuple[str, ...]) -> tuple[Document, Files]:
    document = read_document(path, Resources([*map(Path, folders)]))
    return document, [path, *document.files]


def _scripted(person: Person) -> Trajectory:
    path, script = person.file, person.element.find("script")
    if script is None:
        return Trajectory(person.name, (tuple(person.pose[:3, 3].tolist()),), (0.0,))
    points, times = _way_points(script, path)
    placed = np.array(points) @ person.pose[:3, :3].T + person.pose[:3, 3]
    loops = is_true(text_of(script, "loop", "true"))
    where = f"{path}: delay_start of {person.name}"
    (delay,) = numbers(text_of(script, "delay_start", "0"), 1, where)
    return Trajectory(person.name, tuple(map(tuple, placed.tolist())), times, loops, delay)


def _way_points(parent: Element, path: Path) -> tuple[tuple[Point, ...], tuple[float, ...]]:
    points = list(parent.iter("waypoint"))
    if not 1 <= len(points) <= LONGEST_ROUTE:
        raise UsageError(f"{path} has {len(points)} way points; give 1 to {LONGEST_ROUTE:,}")
    poses = [numbers(text_of(point, "pose"), 6, f"{path}: way point") for point in points]
    stamps = (numbers(text_of(point, "time", "0"), 1, f"{path}: time") for point in points)
    return tuple(pose[:3] for pose in poses), tuple(time for (time,) in stamps)


@dataclass(frozen=True)
class Pedestrian:
    """One person, before there is a world."""

    name: str  # of the topic: /NAME_actor/pose
    options: ActorOptions  # speed, size and the like
    trajectory: Trajectory | None = None  # the way points of the walk; None if a walker chooses its own
    walker: str = ""  # "random" or "social"; "" if there is a trajectory

    @property
    def full_name(self) -> str:
        """Name of the body, and of the topic before /pose."""
        return f"{self.name}_actor"


def pedestrians(specs: Sequence[ActorSpec], folders: Sequence[str]) -> tuple[Pedestrian, ...]:
    """Returns the people that are asked for; UsageError if a file is not valid or a name is there twice.

    What files include is looked for in the folders first.
    """
    people = [person for spec in specs for person in _people_of(spec, tuple(folders))]
    names = [person.name for person in people]
    if twice := repeated(names):
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
        if _document(path, tuple(folders)).actors:
            return (ActorSpec(terrain, "", ActorOptions(), file=terrain),)
    return ()


def _people_of(spec: ActorSpec, folders: tuple[str, ...]) -> tuple[Pedestrian, ...]:
    text, name, options = spec.text, spec.name, spec.options
    if spec.walker:
        return (Pedestrian(_checked(text, name), options, walker=spec.walker),)
    if spec.points:
        return (Pedestrian(_checked(text, name), options, Trajectory(name, spec.points)),)
    trajectories = read_trajectories(Path(spec.file), folders)
    if name and len(trajectories) > 1:
        raise UsageError(
            f"actor '{text}': {spec.file} has {len(trajectories)} actors with names; leave out '{name}='"
        )
    names = [name] if name else _of_topics([one.name for one in trajectories])
    return tuple(
        Pedestrian(_checked(text, short), options, one)
        for short, one in zip(names, trajectories, strict=True)
    )


def _of_topics(names: Sequence[str]) -> list[str]:
    """Returns people's names as topics can have them; a changed one that is taken gets a number."""
    taken, found = set(names), list[str]()
    for name in names:
        if (short := _of_topic(name)) != name:
            short = next(n for n in chain([short], (f"{short}_{i}" for i in count(2))) if n not in taken)
            taken.add(short)
        found.append(short)
    return found


def _of_topic(name: str) -> str:
    """Returns a person's name as a topic can have it: in ASCII without accents, from a letter on."""
    plain = unicodedata.normalize("NFKD", name.strip()).encode("ascii", "ignore").decode()
    words = re.sub(r"\W+", "_", plain).strip("_")
    return words if words[:1].isalpha() else f"person_{words}".rstrip("_")


def _checked(text: str, name: str) -> str:
    short = name.removesuffix("_actor")
    if not NAME.fullmatch(short):
        raise UsageError(
            f"actor '{text}': '{name}' cannot be part of a topic's name; begin with a letter, "
            "go on with letters, digits and _, as in guide=FILE.sdf"
        )
    return short
