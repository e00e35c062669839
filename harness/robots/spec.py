"""What a rover is: RoverFile as rover.yaml says it, RoverSpec complete."""

import json
import math
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Field

from harness.robots.sections import (
    ACKERMANN,
    Actuators,
    BatteryPack,
    Drive,
    Expected,
    FrameRow,
    Mount,
    Number,
    Positive,
    Shake,
    Surface,
    Tyres,
)
from harness.spec.value import Value
from harness.spec.world import GRAVITY

Bounds = tuple[Number, Number, Number, Number]  # x_min, x_max, y_min, y_max [m]
_COLUMNS = {1: ("",), 2: ("front_", "rear_"), 3: ("front_", "middle_", "rear_")}


def _not_empty(bounds: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    if not (bounds[0] < bounds[1] and bounds[2] < bounds[3]):
        raise ValueError(f"footprint = {bounds} is empty; give x_min, x_max, y_min, y_max in metres")
    return bounds


def _measured(description: str) -> Any:  # noqa: ANN401 - as Field itself
    """A key that may be left out, for its value is then derived from the model."""
    return Field(default_factory=lambda: None, description=description)


class RoverFile(Value):
    """What rover.yaml says; lengths in metres, angles in radians, rates in hertz of simulation time.

    The root body of the model is the model frame, whose pose is in /rover/pose_array. Keys that are
    left out are None here, and have a value in a RoverSpec.
    """

    model_config = ConfigDict(validate_default=False)

    model: str = Field(
        default="", description="file name of the MJCF model; default: FOLDER.xml, or the only .xml"
    )
    summary: str = _measured("what the rover is, in a line")
    drive: Drive = Field(default=Drive.model_construct(), description="which joints drive and steer")
    odometry_child_frame: str = _measured("frame of the base")
    imu_frame: str = _measured("frame of the IMU")
    lidar_frame: str = Field(default="lidar_link", description="frame of the lidar, and so of /scan")
    frames: tuple[FrameRow, ...] = Field(
        default=(), description="frames of /tf and the URDF, beside those of the model's bodies"
    )
    lidar: Mount | None = Field(
        default=None, description="where the lidar is, if the model has no site `lidar`"
    )
    imu: Mount | None = Field(
        default=None, description="where the IMU is, if the model has no site `imu`"
    )
    rest_height: Number = _measured(
        "height of the model frame above flat ground when the rover stands on it"
    )
    wheelbase: Positive = _measured(
        "distance of the foremost and the rearmost axle; with Ackermann of the steered axle and the "
        "middle of the others"
    )
    track: Positive = _measured("lateral distance of the wheels")
    footprint: Annotated[Bounds, AfterValidator(_not_empty)] = _measured(
        "x_min, x_max, y_min, y_max over the wheels, in the model frame"
    )
    wheel_width: Positive = _measured("width of the widest wheel, which counts in soil")
    grousers: Annotated[float, Field(ge=0.0, le=2.0)] = Field(
        default=0.0, description="of the wheels, in soil: 0 smooth, 1 as 24 of 5 mm on a wheel of 125 mm"
    )
    lidar_height: Positive = _measured("height of the lidar above flat ground")
    clearance: Positive = _measured("height of the underside above flat ground")
    slope_limit: Positive = Field(
        default=math.radians(40.0), description="steepest slope that the rover climbs"
    )
    step_limit: Positive = _measured("highest step that the rover climbs")
    controller_radius: Positive = _measured("radius of the wheels as the controller believes it")
    controller_separation: Positive = _measured("track as the controller believes it")
    linear_acceleration: Positive = _measured("the controller's limit on commands [m/s^2]")
    angular_acceleration: Positive = _measured("the controller's limit on commands [rad/s^2]")
    encoder_ticks: Positive = _measured("resolution of the encoders per turn of a wheel")
    odometry_rate: Annotated[int, Field(strict=True, gt=0)] = _measured("rate of the wheel odometry")
    cruise_speed: Positive = _measured("speed that the scripted drivers command [m/s]")
    cruise_yaw_rate: Positive = _measured("yaw rate that the scripted drivers command [rad/s]")
    actuators: Actuators | None = Field(
        default=None, description="what the motors can do, for --actuators real"
    )
    battery: BatteryPack | None = Field(default=None, description="for the sensor `battery`")
    tyres: Tyres = Field(default=Tyres.model_construct(), description="how the wheels meet the ground")
    surfaces: dict[str, Surface] = Field(
        default_factory=dict, description="by name, for --surface: tyres on it and what it shakes"
    )
    expected: Expected = Field(
        default_factory=Expected,
        description="what harness.validate expects; without it nothing is judged",
    )
    sensors: tuple[dict[str, Any], ...] = Field(
        default=(), description="optional sensors that the rover carries (docs/sensors.md)"
    )


class ModelFacts(Value):
    """What only the model says of a rover; places are those while all joints are at 0."""

    name: str  # the folder's
    folder: Path
    passive_joints: tuple[str, ...]  # in /joint_states, neither driven nor wheels
    steered_wheels: tuple[str, ...] = ()  # joints of the wheels that the steering turns
    casters: tuple[str, ...] = ()  # bodies beside the wheels that carry it on level ground
    wheel_radius: Positive  # of the largest wheel [m]
    wheel_friction: Positive  # on ground of friction 1
    wheel_speed_limit: Positive  # largest speed of the slowest motor [rad/s]
    gravity: Annotated[float, Field(strict=True, ge=GRAVITY[0], le=GRAVITY[1])]  # downwards [m/s^2]
    lidar_x: Number  # of the lidar ahead in the model frame [m]
    lidar_y: Number = 0.0  # of the lidar to the left [m]
    lidar_z: Number  # of the lidar above the model frame [m]
    lidar_yaw: Number = math.pi  # in which the lidar looks, from the model frame's x [rad]


class RoverSpec(RoverFile, ModelFacts):
    """One rover, complete; lengths in metres, angles in radians, rates in hertz of simulation time."""

    model_config = ConfigDict(validate_default=True)  # what nobody states is no valid value

    real: bool = False  # whether its motors are those of `actuators`, not the model's servos
    vibration: tuple[Shake, ...] = ()  # of the surface that it drives on

    def __hash__(self) -> int:
        """Rovers are told apart by their folders; entries of `sensors` have no hash."""
        return hash(self.folder)

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


def schema() -> str:
    """Returns the JSON schema of rover.yaml as text, for editors."""
    rules = RoverFile.model_json_schema() | {"title": "rover.yaml"}
    return json.dumps(rules, indent=1, ensure_ascii=False) + "\n"


def _named(count: int, side: str) -> tuple[str, ...]:
    columns = _COLUMNS.get(count) or tuple(f"{n}_" for n in range(1, count + 1))
    return tuple(f"{column}{side}" for column in columns)
