"""What is measured on rovers of every kind, beside what their files say in numbers."""

import math
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.robots import ROVERS, RoverSpec
from harness.robots.measures import Measures
from harness.robots.reading import read_rover


def wheel(
    name: str, place: str, radius: float = 0.1, width: float = 0.06, shape: str = "cylinder"
) -> str:
    """A body on a hinge about y; its mass is that of its shape."""
    sizes = f"{radius} {width / 2}" if shape == "cylinder" else f"{radius} {radius} {width / 2}"
    geom = f'<geom type="{shape}" size="{sizes}" euler="90 0 40"/>'
    return f'<body name="{name}" pos="{place}"><joint name="{name}" axis="0 1 0"/>{geom}</body>'


def motors(**limits: float) -> str:
    """Velocity servos with those limits [rad/s]."""
    line = '<velocity joint="{0}" kv="5" ctrlrange="-9 {1}" forcerange="-5 5"/>'
    return "".join(line.format(joint, limit) for joint, limit in limits.items())


def steered(name: str, place: str, joint: str = "") -> str:
    """A wheel below a hinge about z."""
    inertial = '<inertial mass="0.1" pos="0 0 0" diaginertia="1e-3 1e-3 1e-3"/>'
    hinge = f'<joint name="steer_{name}" axis="0 0 1" {joint}/>{inertial}'
    return f'<body name="hinge_{name}" pos="{place}">{hinge}{wheel(name, "0 0 0")}</body>'


def car(body: str, actuators: str, more: str = "") -> str:
    """MJCF as somebody may have it, with a floor."""
    hull = '<geom name="hull" type="box" size="0.3 0.1 0.05" pos="0.05 0 0.2"/>'
    root = f'<body name="car" pos="1 2 3">{hull}{body}</body>'
    return (
        f'<mujoco>{more}<worldbody><geom type="plane" size="9 9 1"/>{root}</worldbody>'
        f"<actuator>{actuators}</actuator></mujoco>"
    )


FRONT_STEERS = "drive: {kind: ackermann, steering: [steer_a, steer_c]}\n"
FOUR = {"a": "0.2 0.2 0.1", "b": "-0.2 0.2 0.1", "c": "0.2 -0.2 0.1", "d": "-0.2 -0.2 0.1"}
CAR = {  # what most of those below are
    "drive.steering": (),
    "passive_joints": (),
    "steered_wheels": (),
    "wheel_radius": 0.1,
    "wheel_width": 0.06,
    "wheel_friction": 1.0,
    "gravity": 9.81,
    "lidar_x": 0.0,
    "lidar_y": 0.0,
    "lidar_z": 0.3,
    "lidar_yaw": 0.0,
    "odometry_child_frame": "car_link",
    "rest_height": 0.0,
    "wheelbase": 0.4,
    "track": 0.4,
    "footprint": (-0.3, 0.35, -0.23, 0.23),
    "clearance": 0.15,
}
FOUR_DRIVEN = {"drive.left": ("a", "b"), "drive.right": ("c", "d")}
TWO_WHEELS = car(wheel("l", "0 0.15 0.1") + wheel("r", "0 -0.15 0.1"), motors(l=4, r=6))
# The rear axle hangs in the air, its wheels are larger and wider, its motors slower; a hinge without
# a motor.
UNEQUAL_AXLES = car(
    "".join(wheel(n, FOUR[n]) for n in "ac")
    + "".join(wheel(n, FOUR[n].replace("0.1", "0.17"), 0.15, 0.08, "ellipsoid") for n in "bd")
    + '<body name="mast" pos="0 0 0.3"><joint name="pan" axis="0 0 1"/>'
    '<geom type="sphere" size="0.02"/></body>',
    motors(a=8, b=3, c=8, d=3),
)
LONE_SHELL = (  # nothing but slippery wheels and a mass collides
    car("".join(wheel(n, FOUR[n]) for n in FOUR), motors(a=3, b=3, c=3, d=3))
    .replace('name="hull"', 'name="hull" contype="0" conaffinity="0"')
    .replace('<geom type="cylinder"', '<geom friction="0.5" type="cylinder"')
)
SIX_WHEELS = car(
    steered("a", FOUR["a"], 'range="-30 20"')
    + steered("c", FOUR["c"], 'range="-25 35"')
    + "".join(wheel(n, FOUR[n]) for n in "bd")
    + wheel("e", "-0.5 0.2 0.1")
    + wheel("f", "-0.5 -0.2 0.1"),
    motors(b=7, d=7, e=5, f=7)
    + '<position joint="steer_a" kp="9" ctrlrange="-0.5 0.3"/>'
    + '<position joint="steer_c" kp="9" ctrlrange="-0.6 0.4"/>',
)
STEERS = {
    "summary": "23.5 kg, 6 wheels, Ackermann steering",
    "drive.driven": ("b", "e", "d", "f"),
    "drive.steering": ("steer_a", "steer_c"),
    "drive.steering_limit": 0.3,
    "steered_wheels": ("a", "c"),
    "wheel_speed_limit": 5.0,
    "wheelbase": 0.55,
    "cruise_speed": 0.25,
    "cruise_yaw_rate": 0.12639,  # 0.25 m/s on a circle of 0.55 / tan(0.3) + 0.4 / 2
    "footprint": (-0.6, 0.35, -0.23, 0.23),
    "reach": math.hypot(0.6, 0.23),
    "tightest_turn": 1.978,
    "motors": ("b", "e", "d", "f", "steer_a", "steer_c"),
}
STOPS = {  # of joints, not of motors
    "drive.steering_limit": math.radians(15),
    "cruise_yaw_rate": 0.110981,
    "tightest_turn": 0.55 / math.tan(math.radians(15)) + 0.2,
}
ROCKERS = car(  # hinges about y with limits, whose links reach the ground as wheels do
    "".join(
        f'<body name="rocker_{s}" pos="0 {y} 0.15"><joint name="rocker_{s}" axis="0 1 0" '
        f'range="-20 20"/><geom type="box" size="0.2 0.02 0.02"/>'
        + wheel(f"front_{s}", "0.2 0 -0.05")
        + wheel(f"rear_{s}", "-0.2 0 -0.05")
        + "</body>"
        for s, y in (("L", 0.2), ("R", -0.2))
    ),
    motors(front_L=9, rear_L=9, front_R=9, rear_R=2),
)
SIX_STEER = FRONT_STEERS.replace("drive: {", "drive: {left: [a, b, e], right: [c, d, f], ")
MADE: dict[str, tuple[str, str, dict[str, object]]] = {  # model, rover.yaml, what differs from CAR
    "two_wheels": (
        TWO_WHEELS,
        "",
        {
            "summary": "15.8 kg, 2 wheels, skid steer",
            "drive.driven": ("l", "r"),
            "wheel_speed_limit": 4.0,
            "wheelbase": 0.2,  # a wheel's diameter
            "track": 0.3,
            "footprint": (-0.25, 0.35, -0.18, 0.18),
            "cruise_speed": 0.2,
            "cruise_yaw_rate": 1.0,
            "top_speed": 0.4,
            "reach": math.hypot(0.35, 0.18),
            "length": 0.6,
            "wheel_names": ("left", "right"),
        },
    ),
    "unequal_axles": (
        UNEQUAL_AXLES,
        "lidar: {body: mast, xyz: [0.1, 0.2, 0.3], rpy: [0, 0, 1.5]}\nimu: {body: mast}\n",
        {
            "summary": "23.3 kg, 4 wheels, skid steer",
            **FOUR_DRIVEN,
            "passive_joints": ("pan",),
            "wheel_radius": 0.15,
            "wheel_width": 0.08,
            "wheel_speed_limit": 3.0,
            "lidar_x": 0.1,
            "lidar_y": 0.2,
            "lidar_z": 0.6,
            "lidar_yaw": 1.5,
            "footprint": (-0.35, 0.35, -0.24, 0.24),
            "cruise_speed": 0.225,
            "step_limit": 0.075,
        },
    ),
    "lone_shell": (
        LONE_SHELL,
        "",
        {
            "lidar_z": 0.25,
            "footprint": (-0.3, 0.3, -0.23, 0.23),
            "clearance": 0.1,
            "cruise_speed": 0.15,
            "cruise_yaw_rate": 0.75,
        },
    ),
    "six_wheels": (SIX_WHEELS, SIX_STEER, STEERS),
    "stops_right": (SIX_WHEELS.replace("-25 35", "-15 35"), SIX_STEER, STEERS | STOPS),
    "stops_left": (SIX_WHEELS.replace("-30 20", "-30 15"), SIX_STEER, STEERS | STOPS),
    "rockers": (
        ROCKERS,
        "",
        {
            "drive.left": ("front_L", "rear_L"),
            "drive.right": ("front_R", "rear_R"),
            "passive_joints": ("rocker_L", "rocker_R"),
            "wheel_speed_limit": 2.0,
            "clearance": 0.13,
            "cruise_yaw_rate": 0.5,
        },
    ),
}


@pytest.mark.parametrize("name", MADE)
def test_a_rover_is_measured_as_by_hand(name: str, tmp_path: Path) -> None:
    model, yaml, differs = MADE[name]
    (tmp_path / "car.xml").write_text(model)
    (tmp_path / "rover.yaml").write_text(yaml or "model: car.xml\n")
    rover = read_rover(tmp_path)
    for key, value in (CAR | differs).items():
        section, _, field = key.rpartition(".")
        measured = getattr(rover.drive if section else rover, field)
        exact = not isinstance(value, float) and key != "footprint"
        assert measured == (value if exact else pytest.approx(value, abs=1e-6)), key


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_a_shipped_rover_is_measured_as_it_says(rover: RoverSpec) -> None:
    measured = Measures(rover).derived()
    for key in ("rest_height", "wheelbase", "track", "lidar_height", "footprint"):
        assert measured[key] == pytest.approx(getattr(rover, key), abs=2e-3), key
    for key, value in Measures(rover).facts().items():
        read = getattr(rover, key)
        assert value == (pytest.approx(read) if "wheel_" in key or key == "gravity" else read), key


@pytest.mark.parametrize(
    ("limits", "told"),
    [
        ('joint="steer_a"', "key 'steering_limit' is missing"),
        ('joint="steer_a" ctrlrange="0 0.3"', "key 'steering_limit' is missing"),
    ],
)
def test_a_steering_without_a_limit_needs_one(limits: str, told: str, tmp_path: Path) -> None:
    body = (
        steered("a", FOUR["a"]) + steered("c", FOUR["c"]) + wheel("b", FOUR["b"]) + wheel("d", FOUR["d"])
    )
    servos = f'<position {limits} kp="9"/><position joint="steer_c" kp="9"/>'
    (tmp_path / "car.xml").write_text(car(body, motors(b=7, d=7) + servos))
    sides = "drive: {left: [a, b], right: [c, d], "
    (tmp_path / "rover.yaml").write_text(FRONT_STEERS.replace("drive: {", sides))
    with pytest.raises(UsageError, match=told):
        read_rover(tmp_path)
    text = FRONT_STEERS.replace("drive: {", sides + "steering_limit: 0.7, ")
    (tmp_path / "rover.yaml").write_text(text)
    assert read_rover(tmp_path).drive.steering_limit == 0.7
