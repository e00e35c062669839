"""The sections of rover.yaml: frames, mounts, the drive, what is expected of the rover."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from pydantic import ConfigDict, Field

from harness.spec.value import Value

SKID: Literal["skid"] = "skid"
ACKERMANN: Literal["ackermann"] = "ackermann"

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, gt=0.0, allow_inf_nan=False)]
# [m] and [rad] of what is on a rover: more is in millimetres, and more than a turn in degrees.
Coordinate = Annotated[float, Field(strict=True, ge=-20.0, le=20.0)]
Vector = tuple[Coordinate, Coordinate, Coordinate]
Angle = Annotated[float, Field(strict=True, ge=-round(math.tau, 4), le=round(math.tau, 4))]
Angles = tuple[Angle, Angle, Angle]


class FrameRow(Value):
    """One frame of rover.yaml: where `child` is, in what is named."""

    parent: str
    child: str
    body: str = Field(
        default="",
        description="the model's body that it belongs to, whose mass and shapes its link has in the "
        "URDF; with neither body nor site it is fixed to `parent`",
    )
    site: str = Field(default="", description="the model's site that it is at")
    xyz: Vector = Field(default=(0.0, 0.0, 0.0), description="its origin there, else in the parent [m]")
    rpy: Angles = Field(default=(0.0, 0.0, 0.0), description="its roll, pitch and yaw there [rad]")


class Mount(Value):
    """Where a sensor is on a model that has no site for it."""

    body: str = Field(default="", description="the model's body that carries it; empty: the root body")
    xyz: Vector = Field(default=(0.0, 0.0, 0.0), description="its origin in that body [m]")
    rpy: Angles = Field(default=(0.0, 0.0, 0.0), description="its roll, pitch and yaw there [rad]")


class Drive(Value):
    """Which joints drive and steer."""

    kind: Literal["skid", "ackermann"] = Field(
        default=SKID,
        description="skid: the wheels of a side turn alike and the rover turns by their difference; "
        "ackermann: the front wheels are steered",
    )
    left: tuple[str, ...] = Field(default=(), description="joints of the left wheels, front to rear")
    right: tuple[str, ...] = Field(default=(), description="joints of the right wheels, front to rear")
    driven: tuple[str, ...] = Field(default=(), description="joints of the wheels that have motors")
    steering: tuple[str, ...] = Field(
        default=(), description="joints that turn the left and the right front wheel; ackermann only"
    )
    steering_limit: Annotated[float, Field(strict=True, ge=0.0, le=1.5)] = Field(
        default=0.0, description="largest angle of a steered wheel [rad]; 0: its joint's or motor's"
    )
    steering_rate: Positive = Field(
        default=2.0, description="how fast the mean steered wheel turns [rad/s]"
    )


NotNegative = Annotated[float, Field(strict=True, ge=0.0, allow_inf_nan=False)]


class Actuators(Value):
    """What the motors of a rover can do, with their gears, at the wheels (--actuators real)."""

    voltage: Positive = Field(default=24.0, description="largest that drives a motor [V]")
    motor_constant: Positive = Field(
        description="torque of a motor over its current, and voltage over speed [N m/A, V s/rad]"
    )
    resistance: Positive = Field(description="of a motor [Ohm]")
    current_limit: Positive = Field(description="largest current of a motor [A]")
    gain: Positive | None = Field(
        default=None,
        description="of the speed loop, at a wheel [N m s/rad]; default: the model's servo's",
    )
    inertia: Positive | None = Field(
        default=None,
        description="of the motor and its gear, at a wheel [kg m^2]; default: the model's armature",
    )
    one_motor_a_side: bool = Field(
        default=False,
        description="whether one motor drives all driven wheels of a side, else each its own",
    )
    delay: NotNegative = Field(default=0.0, description="dead time from a command to its effect [s]")
    lag: NotNegative = Field(
        default=0.0, description="of the wheels' speeds behind what the controller wants [s]"
    )
    dead_band: NotNegative = Field(
        default=0.0, description="slower commands of a wheel do nothing [m/s]"
    )
    turn_limit: Positive | None = Field(
        default=None, description="largest difference of the two sides' speeds [m/s]; default: none"
    )
    backlash: NotNegative = Field(default=0.0, description="play between motor and wheel [rad]")
    command_timeout: Positive | None = Field(
        default=None, description="a rover stops this long after the last command [s]; default: never"
    )


class BatteryPack(Value):
    """The battery of a rover (sensor `battery`)."""

    capacity: Positive = Field(description="[W h]")
    full: Positive = Field(description="voltage when full, without load [V]")
    empty: Positive = Field(description="voltage when empty, without load [V]")
    resistance: NotNegative = Field(default=0.0, description="[Ohm]")
    standby: NotNegative = Field(default=0.0, description="what all but the motors takes [W]")

    @property
    def nominal(self) -> float:
        """The mean voltage [V]."""
        return (self.full + self.empty) / 2


class Shake(Value):
    """A part of what tyres and gears add to the vertical acceleration that an IMU reads."""

    sd: NotNegative = Field(description="standard deviation at a wheel speed of 1 m/s [m/s^2]")
    power: NotNegative = Field(default=1.0, description="of the wheels' speed, with which it grows")
    low: NotNegative = Field(default=0.0, description="its lowest frequency [Hz]")
    high: Positive = Field(default=50.0, description="its highest frequency [Hz]")
    spacing: NotNegative = Field(
        default=0.0, description="of the lugs that make it, along the tread [m]; 0: it is a band"
    )


class Tyres(Value):
    """How the wheels meet the ground, where it is not as the model says; None: as it says."""

    friction: Positive | None = Field(default=None, description="coefficient of sliding friction")
    turning: NotNegative = Field(
        default=0.0, description="friction of a contact that spins on the spot, over its load [m]"
    )
    rolling: NotNegative = Field(default=0.0, description="rolling resistance over load")
    falling: NotNegative = Field(
        default=0.0, description="how much of the rolling resistance goes with speed [s/m]"
    )
    drag: NotNegative = Field(
        default=0.0, description="what the ground resists of the rover's motion, over its weight"
    )
    radius: Positive | None = Field(default=None, description="of the wheels [m]")


class Surface(Tyres):
    """What --surface NAME stands for: how tyres differ on it, and what shakes the IMU there."""

    vibration: tuple[Shake, ...] = Field(default=(), description="of the IMU while driving")
    source: str = Field(default="", description="where the numbers come from")


@dataclass(frozen=True, slots=True)
class Span:
    """Lowest and highest expected value, and where they come from; an open end is infinite."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid")

    low: Annotated[float, Field(strict=True)]
    high: Annotated[float, Field(strict=True)]
    source: str

    @property
    def is_open(self) -> bool:
        """Whether nothing is expected."""
        return math.isinf(self.low) and math.isinf(self.high)

    def describe(self, digits: int) -> str:
        """Returns the span as text, rounded to so many decimals."""
        low, high = f"{self.low:.{digits}f}", f"{self.high:.{digits}f}"
        if self.is_open:
            return "-"
        if math.isinf(self.low):
            return f"at most {high}"
        return f"at least {low}" if math.isinf(self.high) else f"{low} to {high}"


OPEN = Span(-math.inf, math.inf, "nothing is expected of it")


class Passage(Value):
    """A place below the rover where rocks may pass, and the height that just does."""

    name: str = Field(description="what is above it")
    aside: Number = Field(description="of the middle of the place, to the left [m]")
    radius: Positive = Field(description="of the largest upright cylinder that no wheel touches [m]")
    height: Positive = Field(description="above flat ground [m]")
    source: str = Field(description="where the height comes from")


def _open(description: str) -> Span:
    span: Span = Field(default_factory=lambda: OPEN, description=description)
    return span


class Expected(Value):
    """What harness.validate expects of a rover; nothing of what is left out."""

    speed_ratio: Span = _open("ground speed over commanded speed, within the wheels' limit")
    at_half: Span = _open("ground speed at a command of 0.5 m/s [m/s]")
    at_top: Span = _open(
        "ground speed at a command of 1.0 m/s, the highest of RoboTerrain's agents [m/s]"
    )
    yaw_ratio: Span = _open("achieved over commanded yaw rate, in place")
    turning_shake: Span = _open(
        "sd of the vertical acceleration turning in place at 1 rad/s, IMU at 100 Hz [m/s^2]; "
        "default: at most 0.3"
    )
    kerb_one_side: Span = _open("height climbed with the wheels of one side [m]")
    rocker_stop: Span = _open("largest angle of a rocker, of a rover that has some [rad]")
    ramp_source: str = Field(
        default="", description="what states the slope climbed, before what it is derived from"
    )
    passages: tuple[Passage, ...] = ()
