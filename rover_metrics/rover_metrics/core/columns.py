"""What a column of the log is, the twelve of RoboTerrain's logs, and a row in their order and format.

Column is the one source of headers and of the data dictionary.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

Cell = int | float | None  # None is an empty cell: there is nothing to say
Field = int | float | str
DECIMALS = 4

_SCAN = "/scan ranges"
_ACCELERATION = "/imu/data linear_acceleration"
_IMU = f"{_ACCELERATION}, angular_velocity"
_COUNTS_SCANS = "no: it counts scans, so a touch at 20 Hz is 20 a second"
_WINDOW = "the window is 100 samples, whatever time they take"
_LATEST = "the latest sample only: a second's other samples do not show"


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column."""

    name: str  # without the unit
    unit: str = ""  # none for a count, a flag, a ratio or text
    meaning: str
    formula: str  # how it is computed, and over which window
    source: str  # topics and fields
    rate_invariant: str = "yes"  # whether the sensor's rate does not show in it, or how it does
    cumulative: bool = False  # it counts or sums from the start on: only its growth says anything

    @property
    def header(self) -> str:
        """How an extended column is called in the log; the twelve stand there without their units."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


# Names, order and meaning never change.
ROBOTERRAIN_COLUMNS = (
    Column(
        name="Timestamp",
        unit="s",
        meaning="ROS time of the row: simulation time with use_sim_time, else Unix time.",
        formula="Whole seconds of the clock.",
        source="/clock or system time",
    ),
    Column(
        name="Total Collisions",
        meaning="Scans so far in which something was near.",
        formula="Scans whose nearest finite range is below collision_threshold, strictly.",
        source=_SCAN,
        rate_invariant=_COUNTS_SCANS,
        cumulative=True,
    ),
    Column(
        name="Current Collision Status",
        meaning="1 while things have been near for a while, else 0.",
        formula="Obstacle Clearance < collision_threshold.",
        source=_SCAN,
        rate_invariant=_WINDOW,
    ),
    Column(
        name="Smoothness Metric",
        unit="m/s^2 + rad/s",
        meaning="The whole ride's shaking so far, gravity included.",
        formula="Sum of |a| + |w| over all samples.",
        source=_IMU,
        rate_invariant="no: it grows with the rate; per sample it does not",
        cumulative=True,
    ),
    Column(
        name="Current Smoothness",
        unit="m/s^2 + rad/s",
        meaning="How rough the ride is now; about 9.8 at rest.",
        formula="Mean of |a| + |w| over the last 100 samples; 0 before the first. RoboTerrain's own "
        "node takes all samples since the start, since January 2025.",
        source=_IMU,
        rate_invariant=_WINDOW,
    ),
    Column(
        name="Obstacle Clearance",
        unit="m",
        meaning="Distance from the lidar to what is nearest; inf before the first range.",
        formula="Mean of the nearest finite range over the last 100 scans that had one.",
        source=_SCAN,
        rate_invariant=_WINDOW,
    ),
    Column(
        name="Distance Traveled",
        unit="m",
        meaning="Length of the path so far, in three dimensions.",
        formula="Sum of the steps between poses shorter than distance_threshold.",
        source="/rover/pose_array poses[0].position",
        rate_invariant="yes, unless the pose is noisy: noise lengthens a path, and a fast one more",
        cumulative=True,
    ),
    Column(
        name="Current Velocity",
        unit="m/s",
        meaning="Speed by the wheels, never negative.",
        formula="Mean of |v| over the last 100 samples; 0 before the first.",
        source="/odometry/wheels twist.twist.linear",
        rate_invariant=_WINDOW,
    ),
    Column(
        name="IMU Acceleration Magnitude",
        unit="m/s^2",
        meaning="How hard the rover was shaken just now, gravity included.",
        formula="|a| of the latest sample; 0 before the first.",
        source=_ACCELERATION,
        rate_invariant=_LATEST,
    ),
    Column(
        name="Is Rough Terrain",
        meaning="1 if it was shaken hard just now, else 0.",
        formula="|a| of the latest sample > rough_terrain_threshold.",
        source=_ACCELERATION,
        rate_invariant=_LATEST,
    ),
    Column(
        name="Vertical Roughness",
        unit="m/s^2",
        meaning="How hard it was shaken just now along the IMU's z axis; about 9.8 at rest.",
        formula="|az| of the latest sample; 0 before the first.",
        source=_ACCELERATION,
        rate_invariant=_LATEST,
    ),
    Column(
        name="Notes",
        meaning="Always `Normal operation`, as RoboTerrain's node writes it.",
        formula="Constant.",
        source="none",
    ),
)

COLUMNS: tuple[str, ...] = tuple(column.name for column in ROBOTERRAIN_COLUMNS)


@dataclass(frozen=True)
class Row:
    """The metrics at one second of ROS time; up to `notes` the fields are COLUMNS, in their order.

    The extended columns are by header; none if they are not asked for.
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
