"""A solid as a file describes it: a shape, and where it is in the world."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Color = tuple[float, float, float, float]  # RGBA, 0..1


@dataclass(frozen=True)
class Primitive:
    """A box, cylinder or ellipsoid; `half_size` as in harness.world.obstacles."""

    shape: Literal["box", "cylinder", "ellipsoid"]
    half_size: tuple[float, ...]


@dataclass(frozen=True)
class Plane:
    """A plane through its origin, solid below; a horizontal one has no end.

    Attributes:
        normal: Of any length.
        size: Along x and y [m]: how much of it is mapped.
    """

    normal: tuple[float, float, float]
    size: tuple[float, float]


@dataclass(frozen=True)
class MeshFile:
    """Triangles of a file.

    Attributes:
        scale: Along x, y and z.
        submesh: The name of the only part of it that is meant; "" for all.
        centred: Whether that part is moved to the origin.
    """

    path: Path
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    submesh: str = ""
    centred: bool = False


@dataclass(frozen=True)
class Relief:
    """A grey picture of heights.

    Attributes:
        size: Along x and y, and from the value 0 to the largest that there can be [m].
        position: Of its middle at the value 0 [m].
    """

    path: Path
    size: tuple[float, float, float]
    position: tuple[float, float, float]


Shape = Primitive | Plane | MeshFile | Relief


@dataclass(frozen=True, eq=False)
class Solid:
    """A shape in the world.

    Attributes:
        name: Unique or not: model::link::collision.
        pose: T_world_solid, shape (4, 4) [m].
        friction: Coulomb's coefficient; None if the file has none.
        color: Of the visual beside it; None if the file has none.
    """

    name: str
    shape: Shape
    pose: NDArray[np.float64]
    friction: float | None = None
    color: Color | None = None
