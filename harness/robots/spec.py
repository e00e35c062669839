"""What a rover is, as values: RoverSpec, and the sections of rover.yaml that it is made of."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

SKID, ACKERMANN = "skid", "ackermann"
DRIVES = (SKID, ACKERMANN)
# What rover.yaml does not say, for the model does; and the folder.
TOLD = (
    "passive_joints", "steered_wheels", "wheel_radius", "wheel_width", "wheel_speed_limit",
    "gravity", "lidar_x", "lidar_y", "lidar_yaw",
)  # fmt: skip
MAY_BE_ZERO = ("rest_height", "lidar_x", "lidar_y", "lidar_yaw")  # or negative
GIVEN = (*TOLD, "name", "folder")
_COLUMNS = {1: ("",), 2: ("front_", "rear_"), 3: ("front_", "middle_", "rear_")}


@dataclass(frozen=True, kw_only=True)
class FrameRow:
    """One frame of rover.yaml: where `child` is, in what is named.

    Attributes:
        body: The model's body that it belongs to, whose mass and shapes its link gets in the URDF, or
            `site`: a site of the model; with neither it is fixed to `parent`.
        xyz: Its origin [m] and `rpy` its roll, pitch, yaw [rad] there, else in the parent.
    """

    parent: str
    child: str
    body: str = ""
    site: str = ""
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Mount:
    """Where a sensor is on a model that has no site for it.

    Attributes:
        body: The model's body that carries it; empty for the root body.
        xyz: Its origin in that body [m].
        rpy: Its roll, pitch, yaw there [rad].
    """

    body: str = ""
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Which joints drive and steer.

    Attributes:
        kind: `skid`: the wheels of a side turn alike and the rover turns by their difference.
            `ackermann`: the front wheels are steered.
        left: Joints of the wheels on the left, front to rear; `right` likewise. Found by their motors
            and their places if left out.
        driven: Joints with a motor; all wheels that have one if left out.
        steering: Joints that steer the left and the right front wheel; ackermann only.
        steering_limit: Largest angle of a steered wheel [rad]; 0 for that of its joint or motor.
        steering_rate: How fast the mean steered wheel turns [rad/s].
    """

    kind: str = SKID
    left: tuple[str, ...] = ()
    right: tuple[str, ...] = ()
    driven: tuple[str, ...] = ()
    steering: tuple[str, ...] = ()
    steering_limit: float = 0.0
    steering_rate: float = 2.0


@dataclass(frozen=True, kw_only=True)
class RoverSpec:
    """One rover; lengths in metres, angles in radians, rates in hertz of simulation time.

    The root body of the model is the model frame, whose pose /rover/pose_array tells.

    Attributes:
        folder: Of its files, and `model`: the name of its MJCF file there.
        summary: What it is, in a line.
        odometry_child_frame: The base frame, and `imu_frame` that of the IMU.
        drive: How it drives; complete, though rover.yaml may leave all of it out.
        passive_joints: Published in /joint_states but neither driven nor wheels; from the model, as are
            `wheel_radius`, `wheel_width`, `wheel_speed_limit` and `gravity` [m/s^2].
        steered_wheels: Joints of the wheels that the steering turns.
        lidar_x: Where the lidar is in the model frame while all joints are at 0, from the model, as are
            `lidar_y` and `lidar_yaw`.
        rest_height: Height of the model frame above flat ground when the rover stands on it.
        track: Lateral wheel distance; `wheelbase` is that of the foremost and the rearmost axle, with
            Ackermann of the steered axle and the middle of the others.
        controller_radius: The wheels' radius as the controller believes it; `controller_separation` is
            the track that it believes.
        footprint: x_min, x_max, y_min, y_max over the wheels, in the model frame.
        linear_acceleration: The controller's limit on commands, as is `angular_acceleration`.
        cruise_speed: What the scripted drivers command; `cruise_yaw_rate` likewise.
        encoder_ticks: Encoder resolution per wheel revolution; `odometry_rate` is that of the odometry.
        lidar_height: Above flat ground, as is `clearance`, that of the underside.
        frames: Of /tf and the URDF; harness.frames adds those of the model that are not named here.
        lidar: Where the lidar is, if the model has no site `lidar`; likewise `imu`.
        slope_limit: Steepest slope that it climbs; `step_limit` is the highest step.
        expected: What harness.validate.check reads.
        sensors: Those that it carries beside the usual ones, each as rover.yaml has it.
    """

    name: str
    folder: Path
    passive_joints: tuple[str, ...]
    wheel_radius: float
    wheel_width: float
    wheel_speed_limit: float
    lidar_x: float
    gravity: float
    summary: str
    odometry_child_frame: str
    imu_frame: str
    rest_height: float
    wheelbase: float
    track: float
    controller_radius: float
    controller_separation: float
    footprint: tuple[float, float, float, float]
    linear_acceleration: float
    angular_acceleration: float
    cruise_speed: float
    cruise_yaw_rate: float
    encoder_ticks: float
    odometry_rate: int
    lidar_height: float
    clearance: float
    model: str = ""
    drive: Drive = field(default_factory=Drive)
    steered_wheels: tuple[str, ...] = ()
    lidar_y: float = 0.0
    lidar_yaw: float = math.pi
    frames: tuple[FrameRow, ...] = ()
    lidar: Mount | None = None
    imu: Mount | None = None
    slope_limit: float = math.radians(40.0)
    step_limit: float = 0.07
    expected: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)
    sensors: tuple[Mapping[str, Any], ...] = field(default=(), hash=False)

    @property
    def model_path(self) -> Path:
        """The rover's MJCF file."""
        return self.folder / (self.model or f"{self.name}.xml")

    @property
    def length(self) -> float:
        """Length of the footprint [m]."""
        return self.footprint[1] - self.footprint[0]

    @property
    def width(self) -> float:
        """Width of the footprint [m]."""
        return self.footprint[3] - self.footprint[2]

    @property
    def reach(self) -> float:
        """Radius of the disc around the model frame that the footprint lies in [m]."""
        x_min, x_max, y_min, y_max = self.footprint
        return math.hypot(max(-x_min, x_max), max(-y_min, y_max))

    @property
    def top_speed(self) -> float:
        """Speed at which the wheels turn as fast as they can [m/s]."""
        return self.wheel_speed_limit * self.wheel_radius

    @property
    def wheel_joints(self) -> tuple[str, ...]:
        """The joints of all wheels: those on the left, front to rear, then those on the right."""
        return self.drive.left + self.drive.right

    @property
    def wheel_names(self) -> tuple[str, ...]:
        """What the wheels are called, e.g. front_left, in the order of `wheel_joints`."""
        return (*_named(len(self.drive.left), "left"), *_named(len(self.drive.right), "right"))

    @property
    def motors(self) -> tuple[str, ...]:
        """The joints that the controller commands: the driven ones, then those of the steering."""
        return self.drive.driven + self.drive.steering

    @property
    def joints(self) -> tuple[str, ...]:
        """Every joint of /joint_states, in its order."""
        return self.wheel_joints + self.drive.steering + self.passive_joints

    @property
    def steers(self) -> bool:
        """Whether it turns by steered wheels, and so not in place."""
        return self.drive.kind == ACKERMANN

    @property
    def tightest_turn(self) -> float:
        """Radius of the tightest circle of the middle of the unsteered axles [m]; 0 in place."""
        if not self.steers:
            return 0.0
        return self.wheelbase / math.tan(self.drive.steering_limit) + self.controller_separation / 2


def _named(count: int, side: str) -> tuple[str, ...]:
    columns = _COLUMNS.get(count) or tuple(f"{n}_" for n in range(1, count + 1))
    return tuple(f"{column}{side}" for column in columns)
