"""One rover of a run: its model, where it starts, who drives it, what it carries and what fails."""

import math
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from harness.base.errors import UsageError
from harness.base.ros_names import check_name
from harness.base.sim_time import CONTROL_PERIOD, period_ticks
from harness.spec.fault import FORM, FaultText
from harness.spec.sensor import SensorChoices
from harness.spec.value import Finite, Option, Value, checked, listed, numbers

CMD_VEL = "cmd_vel"  # the driver that obeys commands
LIDAR_BEAMS, IMU_RATE = 640, 20
DEFAULT_NOISE = "white"

Start = tuple[float, float, float]  # x, y [m], yaw [rad] in the world
Area = tuple[float, float, float, float]  # x from, to, y from, to [m]


def _check_start(start: Start) -> None:
    if abs(start[2]) > math.tau:
        text = ",".join(f"{value:g}" for value in start)
        raise UsageError(
            f"start {text} is not valid; give x and y in metres, and yaw in radians from -6.28 to 6.28"
        )


def _check_area(area: Area) -> None:
    if not (area[0] < area[1] and area[2] < area[3]):
        text = ",".join(f"{value:g}" for value in area)
        raise UsageError(
            f"goal area {text} is not valid; give XMIN,XMAX,YMIN,YMAX in metres, XMIN "
            "below XMAX and YMIN below YMAX"
        )


StartText = Annotated[
    tuple[Finite, Finite, Finite],
    AfterValidator(checked(_check_start)),
    numbers("X,Y or X,Y,YAW in metres and radians", 3, rest=0.0),
]
AreaText = Annotated[
    tuple[Finite, Finite, Finite, Finite],
    AfterValidator(checked(_check_area)),
    numbers("XMIN,XMAX,YMIN,YMAX in metres", 4),
]


class RoverSetup(Value):
    """What determines one rover of a run and its drive.

    `name` is the rover's namespace and its folder of logs among several; "" for a rover that is alone.
    """

    name: Annotated[str, AfterValidator(checked(check_name))] = ""
    robot: Annotated[str, Option("NAME|FOLDER")] = Field(
        default="leo", description="a rover that ships, or a folder (docs/robots.md)"
    )
    start: Annotated[StartText | None, Option("X,Y[,YAW]")] = Field(
        default=None,
        description="start [m] and heading from +x to +y [rad]; default: at or next to 0,0, the middle",
    )
    driver: Annotated[str, Option("NAME")] = Field(
        default="wander", description="who chooses the commands, or policy:FILE.npz (docs/gym.md)"
    )
    goal_area: Annotated[AreaText | None, Option("XMIN,XMAX,YMIN,YMAX")] = Field(
        default=None,
        description="give the driver one random goal after another in this rectangle [m], as "
        "RoboTerrain's collector",
    )
    actuators: Annotated[Literal["ideal", "real"], Option("NAME")] = Field(
        default="ideal",
        description="ideal: the model's servos; real: motors that lag, as rover.yaml says "
        "(docs/real_rovers.md)",
    )
    surface: Annotated[str, Option("NAME")] = Field(
        default="", description="tyres and vibration on a surface that rover.yaml knows; default: none"
    )
    cmd_vel_timeout: Annotated[
        Annotated[float, Field(ge=CONTROL_PERIOD, allow_inf_nan=False)] | None, Option("S")
    ] = Field(
        default=None,
        description="stop S simulated seconds after the last command; off by default, "
        "with real actuators what rover.yaml says",
    )
    lidar_beams: Annotated[int, Field(ge=2, le=100_000), Option("N")] = Field(
        default=LIDAR_BEAMS, description="beams of the lidar, all around"
    )
    imu_rate: Annotated[int, AfterValidator(checked(period_ticks)), Option("HZ")] = Field(
        default=IMU_RATE, description="samples of the IMU a second"
    )
    noise: Annotated[str | None, Option("NAME", bare=DEFAULT_NOISE)] = Field(
        default=None, description="a preset of sensor errors; none if left out"
    )
    sensors: Annotated[SensorChoices, Option("NAME[,...]")] = Field(
        default=None,
        description="optional sensors, NAME or NAME=PRESET; those of rover.yaml if left out",
    )
    faults: Annotated[tuple[FaultText, ...], listed(), Option("SPEC", flag="fault")] = Field(
        default=(),
        description=f"{FORM}, in simulated seconds, e.g. imu:nan@10+2; repeatable; default: none",
    )
