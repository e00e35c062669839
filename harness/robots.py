"""The rovers: what their model files cannot say (controller, sensor rates, frames, limits).

Geometry and masses live in models/*/; models/README.md gives the source of every number. The values
here are those of RoboTerrain's launch and SDF files unless a comment names another source.
"""

from dataclasses import dataclass
from pathlib import Path

from harness.errors import find_named

MODELS_DIR = next(
    folder
    for folder in (Path(__file__).parent / "models", Path(__file__).parents[1] / "models")
    if folder.is_dir()
)


@dataclass(frozen=True, kw_only=True)
class RoverSpec:
    """One rover; lengths in metres, angles in radians, rates in hertz of simulation time.

    Attributes:
        model_frame: Frame whose pose /rover/pose_array tells: the root body of the model.
        rest_height: Height of that frame above flat ground when the rover stands on it.
        wheel_joints: Front left, rear left, front right, rear right.
        passive_joints: Joints that are published in /joint_states but not driven.
        wheel_radius: True radius; `controller_radius` is what the DiffDrive controller believes.
        track: True lateral wheel distance; `controller_separation` is what DiffDrive believes.
        footprint: x_min, x_max, y_min, y_max over the wheels, in the model frame.
        linear_acceleration: DiffDrive's limit on commands, as is `angular_acceleration`.
        cruise_speed: What the scripted drivers command; `cruise_yaw_rate` likewise.
        encoder_ticks: Encoder resolution per wheel revolution.
    """

    name: str
    summary: str
    model_frame: str
    odometry_child_frame: str
    imu_frame: str
    rest_height: float
    wheel_joints: tuple[str, str, str, str]
    passive_joints: tuple[str, ...]
    wheel_radius: float
    wheel_width: float
    wheelbase: float
    track: float
    controller_radius: float
    controller_separation: float
    footprint: tuple[float, float, float, float]
    wheel_speed_limit: float
    linear_acceleration: float
    angular_acceleration: float
    cruise_speed: float
    cruise_yaw_rate: float
    encoder_ticks: float
    odometry_rate: int
    lidar_x: float
    lidar_height: float
    clearance: float

    @property
    def model_path(self) -> Path:
        """The rover's MJCF file."""
        return MODELS_DIR / self.name / f"{self.name}.xml"

    @property
    def length(self) -> float:
        """Of the footprint [m]."""
        return self.footprint[1] - self.footprint[0]

    @property
    def width(self) -> float:
        """Of the footprint [m]."""
        return self.footprint[3] - self.footprint[2]

    @property
    def top_speed(self) -> float:
        """At which the wheels turn as fast as they can [m/s]."""
        return self.wheel_speed_limit * self.wheel_radius

    @property
    def joints(self) -> tuple[str, ...]:
        """Every joint of /joint_states, in its order."""
        return self.wheel_joints + self.passive_joints


LEO = RoverSpec(
    name="leo",
    summary="Leo Rover 1.8: 5.5 kg, rocker suspension with differential, lidar 0.80 m up",
    model_frame="base_footprint",
    odometry_child_frame="base_footprint",
    imu_frame="imu_frame",
    rest_height=0.0,
    wheel_joints=("wheel_FL_joint", "wheel_RL_joint", "wheel_FR_joint", "wheel_RR_joint"),
    passive_joints=("rocker_L_joint", "rocker_R_joint"),
    wheel_radius=0.0625,
    wheel_width=0.070,
    wheelbase=0.3051,
    track=0.3579,
    controller_radius=0.0625,
    controller_separation=0.358,
    footprint=(-0.212, 0.218, -0.214, 0.214),
    wheel_speed_limit=12.0,
    linear_acceleration=2.5,
    angular_acceleration=3.0,
    cruise_speed=0.4,  # spec page: 0.4 m/s, 60 deg/s
    cruise_yaw_rate=1.0,
    encoder_ticks=878.4,  # leo_fw default_firmware_params.yaml
    odometry_rate=20,
    lidar_x=0.174,
    lidar_height=0.798,
    clearance=0.106,
)

ROVER_ZERO4WD = RoverSpec(
    name="rover_zero4wd",
    summary="Rover Robotics Zero 4WD: 12.5 kg, no suspension, lidar 0.32 m up",
    model_frame="base_link",
    odometry_child_frame="base_link",
    imu_frame="imu_link",
    rest_height=0.002,
    wheel_joints=(
        "fl_wheel_to_chassis",
        "rl_wheel_to_chassis",
        "fr_wheel_to_chassis",
        "rr_wheel_to_chassis",
    ),
    passive_joints=(),
    wheel_radius=0.127,
    wheel_width=0.083,
    wheelbase=0.2865,
    track=0.360,
    controller_radius=0.122,  # RoboTerrain's DiffDrive believes these two
    controller_separation=0.24,
    footprint=(-0.272, 0.268, -0.223, 0.223),
    wheel_speed_limit=10.0,  # estimate; the real driver's open-loop maximum is 9.27 rad/s
    linear_acceleration=5.0,
    angular_acceleration=4.0,
    cruise_speed=0.5,
    cruise_yaw_rate=2.0,
    encoder_ticks=4096.0,  # estimate: fine enough to stay below the simulator's own slip
    odometry_rate=50,
    lidar_x=0.174,
    lidar_height=0.323,
    clearance=0.049,
)

ROVERS = {rover.name: rover for rover in (LEO, ROVER_ZERO4WD)}


def find_rover(name: str) -> RoverSpec:
    """Returns the rover of that name.

    Raises:
        UsageError: No such rover; the message names those there are.
    """
    return find_named("robot", name, ROVERS)
