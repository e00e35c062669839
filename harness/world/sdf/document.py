"""What an SDF file holds: solids in the frame of the world, gravity, actors, and what cannot be had."""

from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

from harness.base.sdf.poses import Transform
from harness.world.solid import Solid


@dataclass(frozen=True, eq=False)
class Person:
    """An <actor>, whose script harness.world.actors reads."""

    name: str
    element: Element
    pose: Transform  # T_world_actor: the way points are in its frame
    file: Path  # that it stands in


@dataclass
class Document:
    """What was read; what cannot be had is named once."""

    gravity: float = 9.8  # downwards [m/s^2]
    solids: list[Solid] = field(default_factory=list)
    # the people of the file and of those that it includes
    actors: list[Person] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)  # every SDF file that was read
    # names of those that were left out; `missing` says what else was, and why
    plugins: dict[str, None] = field(default_factory=dict)
    missing: dict[str, None] = field(default_factory=dict)
    # whether its models stand in no <world> and are put on a plane if they bring no ground; not one mesh
    # alone, which may be the ground in another unit
    is_loose: bool = False
    movable: list[str] = field(default_factory=list)  # names of the models that Gazebo would let fall
    restored: list[str] = field(default_factory=list)  # those that Gazebo classic had saved elsewhere

    @property
    def notes(self) -> tuple[str, ...]:
        """What was left out, a line each."""
        left = (
            ("plugins are not run", self.plugins),
            ("not static, but nothing moves here", self.movable),
            ("stand where the <state> that Gazebo classic saved puts them", self.restored),
        )
        lists = (f"{title}: {', '.join(names)}" for title, names in left if names)
        return (*(f"left out: {name}" for name in self.missing), *lists)
