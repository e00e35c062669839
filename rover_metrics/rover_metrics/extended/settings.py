"""What the extended columns need to know beyond the thresholds."""

import math
from dataclasses import dataclass, field

from rover_metrics.errors import ParameterError
from rover_metrics.extended.footprint import Footprint, LidarPose

STANDARD_GRAVITY = 9.80665  # m/s^2, ISO 80000-3
LARGEST = {"footprint_threshold": (100.0, "m"), "gravity": (100.0, "m/s^2")}


@dataclass(frozen=True, kw_only=True)
class ExtendedSettings:
    """Values of the parameters that only the extended columns read.

    Attributes:
        footprint: The rover's outline in the base frame; None leaves the columns of it empty.
        lidar_pose: Where the lidar is in the same frame.
        near_returns_as_contact: Whether a return nearer than range_min (-inf, REP-117) is footprint
            clearance 0.
        footprint_threshold: A scan whose footprint clearance is below this is a footprint collision
            [m]. Contacts show as a few centimetres: lidars and poses of lidars are that exact.
        gravity: Where the IMU is [m/s^2]; a simulator's may differ from the standard one.

    Raises:
        ParameterError: One of the last two is outside its range.
    """

    footprint: Footprint | None = None
    lidar_pose: LidarPose = field(default_factory=LidarPose)
    near_returns_as_contact: bool = False
    footprint_threshold: float = 0.05
    gravity: float = STANDARD_GRAVITY

    def __post_init__(self) -> None:
        for name, (largest, unit) in LARGEST.items():
            value = getattr(self, name)
            if math.isnan(value) or not 0.0 <= value <= largest:
                raise ParameterError(
                    f"{name} = {value} is not valid: it must be from 0.0 to {largest} {unit}"
                )


DEFAULT_EXTENDED = ExtendedSettings()
