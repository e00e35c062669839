"""A named terrain: parameters with units, from which one seed makes heights and obstacles.

Each terrain is a frozen dataclass of its own in harness.world.terrains. A parameter knows its unit
and what it is at the easiest, the default and the hardest difficulty.
"""

import dataclasses
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.world.heightfield import Field, Heightfield, smoothstep
from harness.world.obstacles import Obstacle
from harness.world.statistics import Promise

SPAWN_RADIUS = 1.0  # [m] around the origin that is level, so that a rover can be set down on it
SPAWN_BLEND_RADIUS = 4.0  # [m] from which on the terrain is as it was made
SPAWN_CLEARANCE = 1.5  # [m] around the origin without obstacles
EDGE_CLEARANCE = 1.0  # [m] along the map's edge without obstacles
HEIGHT_DECIMALS = 6  # micrometres: the last bits of sin and FFT differ between processors
DIFFICULTIES = (0.0, 0.5, 1.0)  # easiest, default, hardest

Number = TypeVar("Number", int, float)


def parameter(easiest: Number, default: Number, hardest: Number, unit: str) -> Number:
    """Returns a field of a terrain that follows the difficulty.

    Args:
        easiest: Its value at difficulty 0.
        default: At 0.5.
        hardest: At 1.
        unit: Of all three; "" for none.
    """
    return field(default=default, metadata={"values": (easiest, default, hardest), "unit": unit})


def constant(value: Number, unit: str) -> Number:
    """Returns a field of a terrain that no difficulty changes."""
    return parameter(value, value, value, unit)


@dataclass(frozen=True, kw_only=True)
class Terrain(ABC):
    """Base of all terrains."""

    name: ClassVar[str]
    summary: ClassVar[str]
    promise: ClassVar[Promise]
    has_level_spawn: ClassVar[bool] = True
    has_hazards: ClassVar[bool] = False  # whatever seed and difficulty
    soils: ClassVar[tuple[str, ...]] = ()  # of its own, with which it is driven if asked for

    size: float = constant(40.0, "m")  # side length of the map [m]
    cell: float = constant(0.1, "m")  # distance of two vertices [m]

    @abstractmethod
    def _heights(self, x: Field, y: Field, rng: np.random.Generator, /) -> Field:
        """Returns the heights at the vertices x, y, all of shape (n, n) [m]."""

    def obstacles(self, _ground: Heightfield, _rng: np.random.Generator, /) -> tuple[Obstacle, ...]:
        """Returns what stands on that ground; nothing unless a terrain says otherwise."""
        return ()

    @classmethod
    def patches(cls, ground: Heightfield) -> NDArray[np.uint8]:
        """Returns which of `soils` lies at each vertex; the first unless a terrain says otherwise."""
        return np.zeros(ground.heights.shape, np.uint8)

    def ground(self, rng: np.random.Generator) -> Heightfield:
        """Returns the surface, level around the spawn."""
        half_size, vertices = 0.5 * self.size, round(self.size / self.cell) + 1
        axis = np.linspace(-half_size, half_size, vertices)
        x, y = np.meshgrid(axis, axis)
        heights = np.asarray(self._heights(x, y, rng))
        if (
            heights.shape != x.shape
            or heights.dtype.kind not in "biuf"
            or not np.isfinite(heights).all()
        ):
            text = f"terrain {self.name}: its _heights give no {vertices} x {vertices} finite numbers"
            raise UsageError(text)
        if self.has_level_spawn:
            distance = np.hypot(x, y)
            level = heights[distance <= SPAWN_RADIUS].mean()
            kept = smoothstep(distance, SPAWN_RADIUS, SPAWN_BLEND_RADIUS)
            heights = level + (heights - level) * kept
        # Adding zero turns -0.0 into 0.0, which is another byte.
        return Heightfield(heights=np.round(heights, HEIGHT_DECIMALS) + 0.0, cell=self.cell)

    @classmethod
    def at_difficulty(cls, difficulty: float) -> Self:
        """Returns the terrain with all parameters at a difficulty of 0 (easiest) to 1 (hardest)."""
        values: dict[str, Any] = {}
        for item in _parameters(cls):
            value = float(np.interp(difficulty, DIFFICULTIES, item.metadata["values"]))
            values[item.name] = round(value) if isinstance(item.default, int) else value
        return cls(**values)

    @classmethod
    def describe(cls) -> str:
        """Returns every parameter with its unit, as 'default (easiest..hardest)' where it varies."""
        return ", ".join(
            f"{item.name} {_spread(*item.metadata['values'])} {item.metadata['unit']}".rstrip()
            for item in _parameters(cls)
        )


def _parameters(kind: type[Terrain]) -> list[dataclasses.Field[Any]]:
    """The fields of a terrain that have a unit and follow the difficulty."""
    return [item for item in fields(kind) if "values" in item.metadata]


def _spread(easiest: float, default: float, hardest: float) -> str:
    varies = easiest != default or default != hardest
    return f"{default:g} ({easiest:g}..{hardest:g})" if varies else f"{default:g}"
