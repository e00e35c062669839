"""One line of the metrics log: twelve columns, in the order and format of RoboTerrain's logs."""

from dataclasses import dataclass, fields
from typing import Protocol

from rover_metrics.core.roboterrain_columns import ROBOTERRAIN_COLUMNS

COLUMNS: tuple[str, ...] = tuple(column.header for column in ROBOTERRAIN_COLUMNS)

DECIMALS = 4

Field = int | float | str


class Row(Protocol):
    """A line of a log."""

    @property
    def stamp_s(self) -> int:
        """ROS time [s]."""
        ...

    @property
    def columns(self) -> tuple[str, ...]:
        """The header that fits it."""
        ...

    def as_fields(self) -> tuple[Field, ...]:
        """Its CSV cells."""
        ...


@dataclass(frozen=True)
class MetricsRow:
    """The metrics at one second; the fields stand in the order of COLUMNS, which describe them."""

    stamp_s: int
    total_collisions: int
    collision_status: int
    smoothness_metric: float
    current_smoothness: float
    obstacle_clearance: float
    distance_traveled: float
    current_velocity: float
    imu_acceleration_magnitude: float
    is_rough_terrain: int
    vertical_roughness: float
    notes: str = "Normal operation"

    @property
    def columns(self) -> tuple[str, ...]:
        """The header that fits the row."""
        return COLUMNS

    def as_fields(self) -> tuple[Field, ...]:
        """Returns the CSV cells, floats rounded to four decimals."""
        return tuple(_cell(getattr(self, column.name)) for column in fields(self))


def _cell(value: Field) -> Field:
    return round(value, DECIMALS) if isinstance(value, float) else value
