"""One line of the metrics log, in the order and format of RoboTerrain's logs."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

from rover_metrics.core.columns import ROBOTERRAIN_COLUMNS, Cell

COLUMNS: tuple[str, ...] = tuple(column.name for column in ROBOTERRAIN_COLUMNS)

DECIMALS = 4

Field = int | float | str


@dataclass(frozen=True)
class Row:
    """The metrics at one second of ROS time; up to `notes` the fields are COLUMNS, in their order.

    Attributes:
        extended: The extended columns, by header; empty if they are not asked for.
    """

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
    extended: Mapping[str, Cell] = field(default_factory=dict)

    @property
    def columns(self) -> tuple[str, ...]:
        """The header that fits the row."""
        return (*COLUMNS, *self.extended)

    def as_fields(self) -> tuple[Field, ...]:
        """Returns the CSV cells, floats rounded to four decimals; an empty one is empty text."""
        *twelve, extended = (getattr(self, column.name) for column in fields(self))
        return tuple(map(_field, (*twelve, *extended.values())))


def _field(cell: Cell | str) -> Field:
    if cell is None:
        return ""
    return round(cell, DECIMALS) if isinstance(cell, float) else cell
