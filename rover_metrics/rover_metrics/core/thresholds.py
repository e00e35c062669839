"""The thresholds that turn readings into events, with unit, meaning and valid range of each.

The field definitions below are the one source: validation, ROS parameter descriptors and
documentation all read THRESHOLD_INFO. The threshold 0 switches off what it guards.
"""

from dataclasses import dataclass

from rover_metrics.core.parameter import parameter, parameters_of, require_ranges


@dataclass(frozen=True)
class Thresholds:
    """The thresholds of TraversalMetrics; the defaults are RoboTerrain's.

    Raises:
        ParameterError: A value is outside its valid range or not a number.
    """

    collision_threshold: float = parameter(
        0.2,
        "a scan whose nearest finite range is below this counts as a collision",
        maximum=100.0,
        unit="m",
    )
    smoothness_threshold: float = parameter(
        10.0,
        "acceleration plus angular velocity magnitude above this is rough movement",
        maximum=10000.0,
        unit="m/s^2 + rad/s",
    )
    min_safe_clearance: float = parameter(
        0.5, "obstacle clearance below this is low", maximum=100.0, unit="m"
    )
    distance_threshold: float = parameter(
        0.5,
        "a step between two poses of this length or longer is an outlier, not travel",
        maximum=1000.0,
        unit="m",
    )
    rough_terrain_threshold: float = parameter(
        15.0,
        "acceleration magnitude (gravity included) above this is rough terrain",
        maximum=10000.0,
        unit="m/s^2",
    )

    def __post_init__(self) -> None:
        require_ranges(self)


THRESHOLD_INFO = parameters_of(Thresholds)
DEFAULT_THRESHOLDS = Thresholds()
