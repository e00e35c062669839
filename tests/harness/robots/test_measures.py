"""What is known of rovers of every kind, by closed forms from MuJoCo's fields of their files alone."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.robots import ROVERS, RoverSpec, read_rover
from harness.robots.measures import Measures
from harness.robots.urdf.folder import write_folder
from tests.support.foreign_rovers import FOREIGN, ROVER_4WD_LIKE


def wheel(
    name: str, place: str, radius: float = 0.1, width: float = 0.06, shape: str = "cylinder"
) -> str:
    """A body on a hinge about y; its mass is that of its shape."""
    sizes = f"{radius} {width / 2}" if shape == "cylinder" else f"{radius} {radius} {width / 2}"
    geom = f'<geom type="{shape}" size="{sizes}" zaxis="0 1 0"/>'
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


@dataclass(frozen=True)
class Known:
    """A rover and which of its joints do what, as who made it knows; front to rear."""

    model: str
    left: tuple[str, ...]
    right: tuple[str, ...]
    yaml: str = ""
    steering: tuple[str, ...] = ()
    lidar: tuple[float, float, float, float] | None = None  # x, y, z and yaw, if there is no site


FRONT_STEERS = "drive: {kind: ackermann, steering: [steer_a, steer_c]}\n"
FOUR = {"a": "0.2 0.2 0.1", "b": "-0.2 0.2 0.1", "c": "0.2 -0.2 0.1", "d": "-0.2 -0.2 0.1"}
MADE = {
    "two_wheels": Known(
        car(wheel("l", "0 0.15 0.1") + wheel("r", "0 -0.15 0.1"), motors(l=4, r=6)), ("l",), ("r",)
    ),
    # The rear axle hangs in the air, its wheels are larger and wider, its motors slower; a hinge without
    # a motor.
    "unequal_axles": Known(
        car(
            "".join(wheel(n, FOUR[n]) for n in "ac")
            + "".join(wheel(n, FOUR[n].replace("0.1", "0.17"), 0.15, 0.08, "ellipsoid") for n in "bd")
            + '<body name="mast" pos="0 0 0.3"><joint name="pan" axis="0 0 1"/>'
            '<geom type="sphere" size="0.02"/></body>',
            motors(a=8, b=3, c=8, d=3),
        ),
        ("a", "b"),
        ("c", "d"),
        "lidar: {body: mast, xyz: [0.1, 0.2, 0.3], rpy: [0, 0, 1.5]}\nimu: {body: mast}\n",
        lidar=(0.1, 0.2, 0.6, 1.5),
    ),
    "lone_shell": Known(  # nothing but slippery wheels and a mass collides
        car("".join(wheel(n, FOUR[n]) for n in FOUR), motors(a=3, b=3, c=3, d=3))
        .replace('name="hull"', 'name="hull" contype="0" conaffinity="0"')
        .replace('<geom type="cylinder"', '<geom friction="0.5" type="cylinder"'),
        ("a", "b"),
        ("c", "d"),
    ),
    "six_wheels": Known(
        car(
            steered("a", FOUR["a"], 'range="-30 20"')
            + steered("c", FOUR["c"], 'range="-25 35"')
            + wheel("b", FOUR["b"])
            + wheel("d", FOUR["d"])
            + wheel("e", "-0.5 0.2 0.1")
            + wheel("f", "-0.5 -0.2 0.1"),
            motors(b=7, d=7, e=5, f=7)
            + '<position joint="steer_a" kp="9" ctrlrange="-0.5 0.3"/>'
            + '<position joint="steer_c" kp="9" ctrlrange="-0.6 0.4"/>',
        ),
        ("a", "b", "e"),
        ("c", "d", "f"),
        FRONT_STEERS.replace("drive: {", "drive: {left: [a, b, e], right: [c, d, f], "),
        ("steer_a", "steer_c"),
    ),
    "rockers": Known(  # hinges about y with limits, whose links reach the ground as wheels do
        car(
            "".join(
                f'<body name="rocker_{s}" pos="0 {y} 0.15"><joint name="rocker_{s}" axis="0 1 0" '
                f'range="-20 20"/><geom type="box" size="0.2 0.02 0.02"/>'
                + wheel(f"front_{s}", "0.2 0 -0.05")
                + wheel(f"rear_{s}", "-0.2 0 -0.05")
                + "</body>"
                for s, y in (("L", 0.2), ("R", -0.2))
            ),
            motors(front_L=9, rear_L=9, front_R=9, rear_R=2),
        ),
        ("front_L", "rear_L"),
        ("front_R", "rear_R"),
    ),
}
STEERS = MADE["six_wheels"]
MADE |= {  # whose smallest angle is an end of a joint, not of a motor
    "stops_right": replace(STEERS, model=STEERS.model.replace("-25 35", "-15 35")),
    "stops_left": replace(STEERS, model=STEERS.model.replace("-30 20", "-30 15")),
}


def support(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int, way: tuple[float, float, float]
) -> float:
    """How far a geom reaches in a direction of the world, by the support function of its shape [m]."""
    axes, size = data.geom_xmat[geom].reshape(3, 3), model.geom_size[geom]
    own = axes.T @ np.array(way)
    shapes = mujoco.mjtGeom
    across, along = float(np.hypot(own[0], own[1])), abs(float(own[2]))
    vertices = np.zeros((1, 3))
    if model.geom_type[geom] == shapes.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        begin = int(model.mesh_vertadr[mesh])
        vertices = model.mesh_vert[begin : begin + int(model.mesh_vertnum[mesh])]
    reach = {
        shapes.mjGEOM_BOX: np.abs(own) @ size,
        shapes.mjGEOM_ELLIPSOID: np.linalg.norm(own * size),
        shapes.mjGEOM_SPHERE: size[0],
        shapes.mjGEOM_CAPSULE: size[0] + size[1] * along,
        shapes.mjGEOM_CYLINDER: size[0] * across + size[1] * along,
        shapes.mjGEOM_MESH: (vertices @ own).max(),
    }
    return float(data.geom_xpos[geom] @ np.array(way) + reach[shapes(model.geom_type[geom])])


def at_the_origin(path: Path) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """A model's file with the root body at the origin and all joints at 0."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    model.body_pos[1], model.body_quat[1] = 0.0, (1.0, 0.0, 0.0, 0.0)
    if model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE:
        data.qpos[:7] = 0, 0, 0, 1, 0, 0, 0
    mujoco.mj_forward(model, data)
    return model, data


def steering_ends(model: mujoco.MjModel, names: tuple[str, ...]) -> list[float]:
    """How far joints and their servos turn, to either side [rad]."""
    ends: list[float] = []
    for name in names:
        joint = model.joint(name).id
        ends += np.abs(model.jnt_range[joint]).tolist() if model.jnt_limited[joint] else []
        for motor in np.flatnonzero(model.actuator_trnid[:, 0] == joint):
            if model.actuator_ctrllimited[motor]:
                ends += np.abs(model.actuator_ctrlrange[motor]).tolist()
    return ends


ENDS = {1: ("",), 2: ("front_", "rear_"), 3: ("front_", "middle_", "rear_")}


def by_hand(rover: RoverSpec, known: Known) -> dict[str, object]:
    """What RoverSpec is to say, from the model of the file alone."""
    model, data = at_the_origin(rover.model_path)
    wheels = {name: int(model.joint(name).bodyid[0]) for name in known.left + known.right}
    solid = [
        geom
        for geom in np.flatnonzero(model.geom_contype | model.geom_conaffinity).tolist()
        if model.geom_bodyid[geom] > 0
    ]
    tyres = {
        n: [g for g in solid if model.body_weldid[model.geom_bodyid[g]] == b] for n, b in wheels.items()
    }
    body = [g for g in solid if model.body_weldid[model.geom_bodyid[g]] not in wheels.values()]

    def reach(geoms: list[int], axis: int, sign: float = 1.0) -> float:
        way = [0.0, 0.0, 0.0]
        way[axis] = sign
        return max(support(model, data, geom, (way[0], way[1], way[2])) for geom in geoms)

    box = {n: [(-reach(t, axis, -1.0), reach(t, axis)) for axis in range(3)] for n, t in tyres.items()}
    middle = {n: [sum(ends) / 2 for ends in sides] for n, sides in box.items()}
    radius = max(max(s[0][1] - s[0][0], s[2][1] - s[2][0]) / 2 for s in box.values())
    rest = -min(sides[2][0] for sides in box.values())
    names = [model.joint(j).name for j in range(model.njnt)]
    if model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE:
        names = names[1:]
    velocity = {}
    for motor in range(model.nu):
        if model.actuator_biasprm[motor, 1] == 0.0 and model.actuator_biasprm[motor, 2] < 0.0:
            velocity[model.joint(model.actuator_trnid[motor, 0]).name] = model.actuator_ctrlrange[
                motor, 1
            ]
    driven = tuple(name for name in wheels if name in velocity)
    limit = min(velocity[name] for name in driven)
    angles = steering_ends(model, known.steering)
    carrying = {int(model.joint(name).bodyid[0]) for name in known.steering}
    steered_wheels = tuple(n for n, b in wheels.items() if int(model.body_parentid[b]) in carrying)
    ahead = {name: place[0] for name, place in middle.items()}
    wheelbase = (max(ahead.values()) - min(ahead.values())) or 2 * radius
    if steered_wheels:
        front = [x for name, x in ahead.items() if name in steered_wheels]
        back = [x for name, x in ahead.items() if name not in steered_wheels]
        wheelbase = sum(front) / len(front) - sum(back) / len(back)
    count = len(known.left)
    sides = [middle[name][1] for name in wheels]
    track = sum(sides[:count]) / count - sum(sides[count:]) / count
    cruise = min(0.5 * limit * radius, 1.0)
    turning = min(1.0, limit * radius / track)
    if known.steering:
        turning = cruise / (wheelbase / math.tan(min(angles)) + track / 2)
    lidar = known.lidar or (0.0, 0.0, reach(solid, 2) + 0.05, 0.0)
    if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, "lidar") >= 0:
        site = data.site("lidar")
        lidar = (*site.xpos, math.atan2(site.xmat[3], site.xmat[0]))
    steers, mass = "Ackermann steering" if known.steering else "skid steer", model.body_mass.sum()
    root = model.body(1).name
    keeps = "" if rover.name in FOREIGN else ("_link", "_footprint")  # of a URDF the link's name
    return {
        "summary": f"{mass:.1f} kg, {2 * count} wheels, {steers}",
        "drive.left": known.left,
        "drive.right": known.right,
        "drive.driven": driven,
        "drive.steering": known.steering,
        "drive.steering_limit": min(angles, default=0.0),
        "passive_joints": tuple(n for n in names if n not in (*wheels, *known.steering)),
        "steered_wheels": steered_wheels,
        "wheel_radius": radius,
        "wheel_width": max(s[1][1] - s[1][0] for s in box.values()),
        "wheel_friction": max(
            model.geom_friction[g, 0] if model.geom_priority[g] else max(model.geom_friction[g, 0], 1.0)
            for tyre in tyres.values()
            for g in tyre
        ),
        "wheel_speed_limit": limit,
        "gravity": -model.opt.gravity[2],
        "lidar_x": lidar[0],
        "lidar_y": lidar[1],
        "lidar_z": lidar[2],
        "lidar_yaw": lidar[3],
        "odometry_child_frame": root if root.endswith(keeps) else f"{root}_link",
        "rest_height": rest,
        "lidar_height": lidar[2] + rest,
        "wheelbase": wheelbase,
        "track": track,
        "controller_radius": radius,
        "controller_separation": track,
        "footprint": tuple(s * reach(solid, a, s) for a in (0, 1) for s in (-1.0, 1.0)),
        "clearance": max(0.01, rest - reach(body, 2, -1.0)) if body else radius,
        "cruise_speed": cruise,
        "cruise_yaw_rate": turning,
        "step_limit": radius / 2,
        "linear_acceleration": 2.5,
        "angular_acceleration": 3.0,
        "encoder_ticks": 4096.0,
        "odometry_rate": 50,
        "top_speed": limit * radius,
        "motors": (*driven, *known.steering),
        "reach": max(
            math.hypot(reach(solid, 0, s), reach(solid, 1, r)) for s in (1, -1) for r in (1, -1)
        ),
        "length": reach(solid, 0) + reach(solid, 0, -1.0),
        "width": reach(solid, 1) + reach(solid, 1, -1.0),
        "tightest_turn": wheelbase / math.tan(min(angles)) + track / 2 if angles else 0.0,
        "wheel_names": tuple(f"{end}{side}" for side in ("left", "right") for end in ENDS[count]),
    }


Foreign = Callable[[str], RoverSpec]
STEERED = {"buggy": ("left_steering", "right_steering")}
CORNERS = ("fl", "rl", "fr", "rr")


def rover_of(name: str, folder: Path, foreign: Foreign) -> tuple[RoverSpec, Known]:
    if name in FOREIGN:
        left, right = FOREIGN[name].left, FOREIGN[name].right
        return foreign(name), Known("", left, right, steering=STEERED.get(name, ()))
    if name == "4wd_like":
        (folder / "robot.urdf").write_text(ROVER_4WD_LIKE)
        joints = [f"{corner}_wheel_to_chassis" for corner in CORNERS]
        known = Known("", tuple(joints[:2]), tuple(joints[2:]))
        return write_folder(name, folder / "robot.urdf", folder / name).rover, known
    (folder / "car.xml").write_text(MADE[name].model)
    (folder / "rover.yaml").write_text(MADE[name].yaml or "model: car.xml\n")
    return read_rover(folder), MADE[name]


@pytest.mark.parametrize("name", [*MADE, *FOREIGN, "4wd_like"])
def test_a_rover_is_measured_as_by_hand(name: str, foreign: Foreign, tmp_path: Path) -> None:
    rover, known = rover_of(name, tmp_path, foreign)
    expected = by_hand(rover, known)
    for key, value in expected.items():
        section, _, field = key.rpartition(".")
        measured = getattr(rover.drive if section else rover, field)
        if isinstance(value, float) or key == "footprint":
            assert measured == pytest.approx(value, abs=1e-6), key
        else:
            assert measured == value, key


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_a_shipped_rover_is_measured_as_by_hand_and_says_so(rover: RoverSpec) -> None:
    expected = by_hand(rover, Known("", rover.drive.left, rover.drive.right))
    measured = Measures(rover).facts() | Measures(rover).derived()
    for key in ("rest_height", "wheelbase", "track", "lidar_height", "footprint"):
        assert measured[key] == pytest.approx(expected[key], abs=1e-6), key
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
