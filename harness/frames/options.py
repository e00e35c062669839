"""Which transforms a run tells: who owns odom -> base, and whether there is a map."""

from dataclasses import dataclass

from harness.base.errors import UsageError

GROUND_TRUTH, WHEELS, NONE = "ground_truth", "wheels", "none"
ODOM_SOURCES = (GROUND_TRUTH, WHEELS, NONE)


@dataclass(frozen=True, kw_only=True)
class FrameOptions:
    """What a user chooses of the tree of frames.

    Attributes:
        odom_tf: Who owns odom -> base: the true pose, wheel odometry, or somebody else, such as an EKF.
        odom_tf_3d: Whether the true pose is told whole; else its projection onto the plane, as
            RoboTerrain tells it.
        map_tf: Whether map -> odom is told, as the identity.

    Raises:
        UsageError: The options exclude each other.
    """

    odom_tf: str = GROUND_TRUTH
    odom_tf_3d: bool = False
    map_tf: bool = False

    def __post_init__(self) -> None:
        if self.odom_tf not in ODOM_SOURCES:
            raise UsageError(f"odom_tf '{self.odom_tf}' is not valid; give {', '.join(ODOM_SOURCES)}")
        if self.odom_tf_3d and self.odom_tf != GROUND_TRUTH:
            raise UsageError(
                f"--odom-tf-3d is the true pose: leave out --odom-tf {self.odom_tf}, or --odom-tf-3d"
            )
