"""A solid as a file describes it: a shape, and where it is in the world."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harness.world.obstacles import Color


@dataclass(frozen=True)
class Primitive:
    """A box, cylinder or ellipsoid; `half_size` as in harness.world.obstacles."""

    shape: Literal["box", "cylinder", "ellipsoid"]
    half_size: tuple[float, ...]


@dataclass(frozen=True)
class Plane:
    """A plane through its origin, solid below; a horizontal one has no end."""

    normal: tuple[float, float, float]  # of any length
    size: tuple[float, float]  # along x and y [m]: how much of it is mapped


@dataclass(frozen=True)
class MeshFile:
    """Triangles of a file."""

    path: Path
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)  # along x, y and z
    submesh: str = ""  # the name of the only part of it that is meant; "" for all
    centred: bool = False  # whether that part is moved to the origin


@dataclass(frozen=True)
class Relief:
    """A grey picture of heights, or a survey's."""

    path: Path
    # along x and y, and of a picture's largest value or a survey's relief [m]; None: as surveyed
    size: tuple[float, float, float] | None
    position: tuple[float, float, float]  # of its middle at the value 0 [m]


Shape = Primitive | Plane | MeshFile | Relief


@dataclass(frozen=True, eq=False)
class Solid:
    """A shape in the world."""

    name: str  # unique or not: model::link::collision
    shape: Shape
    pose: NDArray[np.float64]  # T_world_solid, shape (4, 4) [m]
    friction: float | None = None  # Coulomb's coefficient; None if the file has none
    color: Color | None = None  # of the visual beside it; None if the file has none
