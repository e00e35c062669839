"""What the extended columns need to know beyond the thresholds."""

import math
from dataclasses import dataclass, field

from rover_metrics.errors import ParameterError
from rover_metrics.extended.footprint import Footprint, LidarPose

LARGEST_FOOTPRINT_THRESHOLD = 100.0  # m


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

    Raises:
        ParameterError: The threshold is outside its range.
    """

    footprint: Footprint | None = None
    lidar_pose: LidarPose = field(default_factory=LidarPose)
    near_returns_as_contact: bool = False
    footprint_threshold: float = 0.05

    def __post_init__(self) -> None:
        value = self.footprint_threshold
        if math.isnan(value) or not 0.0 <= value <= LARGEST_FOOTPRINT_THRESHOLD:
            message = (
                f"footprint_threshold = {value} is not valid: it must be from 0.0 to "
                f"{LARGEST_FOOTPRINT_THRESHOLD} m"
            )
            raise ParameterError(message)


DEFAULT_EXTENDED = ExtendedSettings()
