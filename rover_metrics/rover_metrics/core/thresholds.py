"""The thresholds that turn readings into events, with unit, meaning and valid range of each.

The field definitions below are the one source: validation, ROS parameter descriptors and
documentation all read THRESHOLD_INFO.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType

from rover_metrics.errors import ThresholdError


@dataclass(frozen=True)
class ThresholdInfo:
    """What one threshold means and which values of it make sense."""

    default: float
    minimum: float
    maximum: float
    unit: str
    description: str

    @property
    def valid_range(self) -> str:
        """The closed interval of valid values, for people."""
        return f"from {self.minimum} to {self.maximum} {self.unit}"


def _threshold(default: float, *, maximum: float, unit: str, description: str) -> float:
    """Define a field whose metadata carries its ThresholdInfo; 0 switches what it guards off."""
    info = ThresholdInfo(default, 0.0, maximum, unit, description)
    declared: float = field(default=default, metadata={"info": info})
    return declared


@dataclass(frozen=True)
class Thresholds:
    """The thresholds of TraversalMetrics; the defaults are RoboTerrain's.

    Raises:
        ThresholdError: A value is outside its valid range or not a number.
    """

    collision_threshold: float = _threshold(
        0.2,
        maximum=100.0,
        unit="m",
        description="a scan whose nearest finite range is below this counts as a collision",
    )
    smoothness_threshold: float = _threshold(
        10.0,
        maximum=10000.0,
        unit="m/s^2 + rad/s",
        description="acceleration plus angular velocity magnitude above this is rough movement",
    )
    min_safe_clearance: float = _threshold(
        0.5,
        maximum=100.0,
        unit="m",
        description="obstacle clearance below this is low",
    )
    distance_threshold: float = _threshold(
        0.5,
        maximum=1000.0,
        unit="m",
        description="a step between two poses of this length or longer is an outlier, not travel",
    )
    rough_terrain_threshold: float = _threshold(
        15.0,
        maximum=10000.0,
        unit="m/s^2",
        description="acceleration magnitude (gravity included) above this is rough terrain",
    )

    def __post_init__(self) -> None:
        for name, info in THRESHOLD_INFO.items():
            value = getattr(self, name)
            if not info.minimum <= value <= info.maximum:
                message = f"{name} = {value} is not valid: it must be {info.valid_range}"
                raise ThresholdError(message)


THRESHOLD_INFO: Mapping[str, ThresholdInfo] = MappingProxyType(
    {threshold.name: threshold.metadata["info"] for threshold in fields(Thresholds)}
)

DEFAULT_THRESHOLDS = Thresholds()
