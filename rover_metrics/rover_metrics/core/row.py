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
    """The metrics at one second; the fields stand in the order of COLUMNS.

    Attributes:
        stamp_s: ROS time [s].
        total_collisions: Scans so far whose nearest range was below the collision threshold.
        collision_status: 1 if the windowed clearance is below the collision threshold, else 0.
        smoothness_metric: Sum of |a| + |w| over all IMU samples so far [m/s^2 + rad/s].
        current_smoothness: Windowed mean of |a| + |w| [m/s^2 + rad/s].
        obstacle_clearance: Windowed mean of the nearest ranges [m]; inf before the first.
        distance_traveled: Path length of the pose so far, outliers left out [m].
        current_velocity: Windowed mean of the wheel odometry speed [m/s].
        imu_acceleration_magnitude: |a| of the latest IMU sample, gravity included [m/s^2].
        is_rough_terrain: 1 if the latest IMU sample is rough, else 0.
        vertical_roughness: |az| of the latest IMU sample, gravity included [m/s^2].
        notes: What an annotator has to say.
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

    @property
    def columns(self) -> tuple[str, ...]:
        """The header that fits the row."""
        return COLUMNS

    def as_fields(self) -> tuple[Field, ...]:
        """Give the CSV cells, floats rounded to four decimals."""
        return tuple(_cell(getattr(self, column.name)) for column in fields(self))


def _cell(value: Field) -> Field:
    return round(value, DECIMALS) if isinstance(value, float) else value
