"""What every field of every message must hold, from the twin's raw states: one row a topic.

Sources: REP-103 (units, axes), REP-105 (frames), REP-117 (ranges), the definitions of the messages,
textbook kinematics. An expectation has the shape of the message: a field that it leaves out fails.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import mujoco
import numpy as np
from scipy.ndimage import uniform_filter
from scipy.spatial.transform import Rotation

from tests.e2e.topic_oracle import ranging, surroundings
from tests.e2e.topic_oracle.form import Expected, header, in_limits, laser_scan, ray, stamp, vector
from tests.e2e.topic_oracle.twin import STEPS_PER_TICK, Twin, Values, attitude
from tests.harness.robots.frames.test_rover_frames import REAL

BEAMS = 24
ANGLE_MAX, RANGE_MIN, RANGE_MAX = 3.14159, 0.15, 10.0  # of RoboTerrain's gpu_lidar
EXACT = 1e-9  # absolute and relative
STANDING = 0.05  # [m/s]: a wheel slower than this neither rolls nor slips


@dataclass(frozen=True)
class Topic:
    """One row.

    Attributes:
        rates: [Hz] of leo, of rover_zero4wd; of several, what is due at any of them; of none, it is
            told once, before the first tick.
        expect: The message that is due now; called at every tick at which one is, in order.
        tolerance: Absolute, of what an array holds.
        depth: Of what is offered; `latched` is whether who comes later is told too.
    """

    name: str
    kind: str
    rates: tuple[int | tuple[int, ...], int | tuple[int, ...]]
    expect: Callable[[Twin], Expected]
    reliable: bool = True
    tolerance: float = EXACT
    depth: int = 10
    latched: bool = False

    def due(self, tick: int, rover: int) -> bool:
        """Whether it is at a tick, counted from 1, of a rover."""
        rates = self.rates[rover]
        # At the first tick by which another period is full: each nth where the rate divides 100.
        every = (rates,) if isinstance(rates, int) else rates
        return any(tick * rate // 100 > (tick - 1) * rate // 100 for rate in every)


def quaternion(rotation: Rotation) -> Expected:
    """geometry_msgs/Quaternion."""
    return dict(zip("xyzw", rotation.as_quat(), strict=True))


def scan(twin: Twin) -> Expected:
    """The lidar looks backwards, beam 0 is its -x axis."""
    data, angles = twin.at_present(), np.linspace(-ANGLE_MAX, ANGLE_MAX, BEAMS)
    site, near_far = data.site("lidar"), (RANGE_MIN, RANGE_MAX)
    along = site.xmat.reshape(3, 3) @ [np.cos(angles), np.sin(angles), np.zeros(BEAMS)]
    ranges = [in_limits(ray(twin, data, site.xpos, ahead)[0], *near_far) for ahead in along.T]
    return laser_scan(header(twin, "lidar_link"), angles, near_far, ranges, BEAMS)


def imu(twin: Twin) -> Expected:
    """Specific force of a point of a rigid body, and rate, in the sensor's axes; means of 50 ms.

    a_P = a_O + R (alpha x r + omega x (omega x r)); a free joint's linear velocity and acceleration are
    in the world's axes, the angular ones in the rover's.
    """
    site, gravity = twin.model.site("imu"), twin.model.opt.gravity
    mounting = Rotation.from_quat(site.quat[[1, 2, 3, 0]])  # R_rover_imu
    window = twin.steps[-5 * STEPS_PER_TICK :]
    qpos, qvel, qacc = (
        np.array([getattr(s, name) for s in window]) for name in ("qpos", "qvel", "qacc")
    )
    omega, alpha = qvel[:, 3:6], qacc[:, 3:6]
    of_origin = attitude(qpos).inv().apply(qacc[:, :3] - gravity)
    of_arm = np.cross(alpha, site.pos) + np.cross(omega, np.cross(omega, site.pos))
    force, rate = (mounting.inv().apply(v.mean(axis=0)) for v in (of_origin + of_arm, omega))
    return {
        "header": header(twin, {"leo": "imu_frame", "rover_zero4wd": "imu_link"}[twin.rover.name]),
        "orientation": quaternion(twin.attitude * mounting),
        "orientation_covariance": np.zeros(9),
        "angular_velocity": vector(rate),
        "angular_velocity_covariance": np.zeros(9),
        "linear_acceleration": vector(force),
        "linear_acceleration_covariance": np.zeros(9),
    }


def pose_array(twin: Twin) -> Expected:
    """The one pose."""
    pose = {"position": vector(twin.data.qpos[:3]), "orientation": quaternion(twin.attitude)}
    return {"header": header(twin, "world"), "poses": [pose]}


def planar_pose(x: float, y: float, yaw: float, covariance: Values) -> Expected:
    """geometry_msgs/PoseWithCovariance on the ground."""
    pose = {
        "position": vector((x, y, 0.0)),
        "orientation": vector((0.0, 0.0, math.sin(yaw / 2))) | {"w": math.cos(yaw / 2)},  # type: ignore[operator]
    }
    return {"pose": pose, "covariance": covariance}


def twist(linear: Any, angular: Any) -> Expected:  # noqa: ANN401 - three numbers each
    """geometry_msgs/TwistWithCovariance, of no covariance."""
    return {"twist": {"linear": vector(linear), "angular": vector(angular)}, "covariance": np.zeros(36)}


def wheel_odometry() -> Callable[[Twin], Expected]:
    """Dead reckoning from whole encoder counts, along the chord of each arc; yaw in -pi..pi."""
    x = y = yaw = 0.0
    counted: Values | None = None

    def expect(twin: Twin) -> Expected:
        nonlocal x, y, yaw, counted
        rover = twin.rover
        counts = twin.encoder_counts() + twin.carried
        if counted is None:
            counted = twin.counts_at_start
        rolled = (counts - counted) / rover.encoder_ticks * math.tau * rover.controller_radius
        counted = counts
        left, right = rolled[:2].mean(), rolled[2:].mean()
        along, turned = (left + right) / 2, (right - left) / rover.controller_separation
        step = along * np.exp(1j * (yaw + turned / 2))
        x, y = x + step.real, y + step.imag
        yaw = float(np.angle(np.exp(1j * (yaw + turned))))
        period = 1 / {"leo": 20, "rover_zero4wd": 50}[rover.name]
        base = {"leo": "base_footprint", "rover_zero4wd": "base_link"}[rover.name]
        return {
            "header": header(twin, "odom"),
            "child_frame_id": base,
            "pose": planar_pose(x, y, yaw, np.zeros(36)),
            "twist": twist((along / period, 0.0, 0.0), (0.0, 0.0, turned / period)),
        }

    return expect


def ground_truth(twin: Twin) -> Expected:
    """The pose from above; the whole velocity, in the axes of the rover."""
    x, y, _ = twin.data.qpos[:3]
    yaw = twin.attitude.as_euler("ZYX")[0]
    return {
        "header": header(twin, "odom"),
        "child_frame_id": "base_footprint",
        "pose": planar_pose(x, y, yaw, np.diag([0.01] * 6).ravel()),
        "twist": twist(twin.attitude.inv().apply(twin.data.qvel[:3]), twin.data.qvel[3:6]),
    }


def joint_states(twin: Twin) -> Expected:
    """Wheels, then what hangs between them; a motor's torque is kv (command - velocity), limited."""
    names = {
        "leo": [f"{joint}_joint" for joint in ("wheel_FL", "wheel_RL", "wheel_FR", "wheel_RR")]
        + ["rocker_L_joint", "rocker_R_joint"],
        "rover_zero4wd": [f"{wheel}_wheel_to_chassis" for wheel in ("fl", "rl", "fr", "rr")],
    }[twin.rover.name]
    joints = [twin.data.joint(name) for name in names]
    model, last = twin.model, twin.steps[-1]
    efforts = np.zeros(len(names))
    for index, wheel in enumerate(twin.wheels):
        motor = model.actuator(wheel.name)
        command = np.clip(last.ctrl[motor.id], *motor.ctrlrange)
        velocity = last.qvel[wheel.dofadr[0]]
        efforts[index] = np.clip(motor.gainprm[0] * (command - velocity), *motor.forcerange)
    return {
        "header": header(twin, ""),
        "name": names,
        "position": [joint.qpos[0] for joint in joints],
        "velocity": [joint.qvel[0] for joint in joints],
        "effort": efforts,
    }


def frames(rover: str, *, moving: bool) -> list[tuple[Any, ...]]:
    """Parent, child, x y z [m] and roll pitch yaw [rad] at rest, of what moves or of what does not."""
    return [
        (*names, at[:3], at[3:])
        for names, at in REAL[rover].items()
        if (names[1].startswith("rocker") or "wheel" in names[1]) == moving
    ]


def joint_of(child: str) -> tuple[str, int]:
    """The joint of a frame that moves, and the sense in which it turns about the y axis of the frame."""
    if child.endswith("_wheel_link"):
        return child.replace("_wheel_link", "_wheel_to_chassis"), 1
    return child.replace("_link", "_joint"), -1 if child.endswith("L_link") else 1


def same(rotation: Rotation) -> Callable[[Any], bool]:
    """A quaternion or its negative, which are one rotation."""

    def is_same(told: Any) -> bool:  # noqa: ANN401 - of rosbags
        turn = Rotation.from_quat([told.x, told.y, told.z, told.w])
        return float((turn.inv() * rotation).magnitude()) < EXACT

    return is_same


def transform(header: Expected, child: str, at: Any, rotation: Rotation) -> Expected:  # noqa: ANN401
    """geometry_msgs/TransformStamped."""
    return {
        "header": header,
        "child_frame_id": child,
        "transform": {"translation": vector(map(float, at)), "rotation": same(rotation)},
    }


def tf_static(twin: Twin) -> Expected:
    """All that does not move; the IMU of the stage is mounted obliquely."""
    site = Rotation.from_quat(twin.model.site("imu").quat[[1, 2, 3, 0]])
    told = []
    carried = surroundings.frames(twin.rover.name)
    for parent, child, at, rpy in (*frames(twin.rover.name, moving=False), *carried):
        rotation = site if child.startswith("imu_") else Rotation.from_euler("xyz", rpy)
        told.append(transform({"stamp": stamp(0), "frame_id": parent}, child, at, rotation))
    if twin.rover.name == "rover_zero4wd":  # which has none of its own
        head = {"stamp": stamp(0), "frame_id": "base_link"}
        told.append(transform(head, "base_footprint", (0.0, 0.0, 0.0), Rotation.identity()))
    return {"transforms": told}


def tf(twin: Twin) -> Expected:
    """The rover from above, in odom; twenty times a second what its joints move."""
    x, y, _ = twin.data.qpos[:3]
    yaw = Rotation.from_euler("z", twin.attitude.as_euler("ZYX")[0])
    base = {"leo": "base_footprint", "rover_zero4wd": "base_link"}[twin.rover.name]
    told = [transform(header(twin, "odom"), base, (x, y, 0.0), yaw)]
    if twin.time_ns % 50_000_000 == 0:
        for parent, child, at, rpy in frames(twin.rover.name, moving=True):
            joint, sense = joint_of(child)
            angle = sense * twin.data.joint(joint).qpos[0]
            rotation = Rotation.from_euler("xyz", rpy) * Rotation.from_euler("y", angle)
            told.append(transform(header(twin, parent), child, at, rotation))
    return {"transforms": told}


def described(twin: Twin) -> Expected:
    """std_msgs/String with a URDF of that rover: test_urdf.py holds it to the model."""

    def is_of_its_mass(told: str) -> bool:
        back = mujoco.MjSpec.from_string(told)
        back.compiler.fusestatic = False
        masses = back.compile().body_mass.sum(), twin.model.body_mass.sum()
        return math.isclose(*masses, abs_tol=1e-6)

    return {"data": is_of_its_mass}


def forces(twin: Twin, kind: str) -> list[float]:
    """Of all contacts of a kind in the last 50 ms."""
    recent = twin.steps[-5 * STEPS_PER_TICK :]
    return [force for step in recent for what, force in step.touched if what == kind]


def slip(twin: Twin, data: mujoco.MjData, body: int) -> float:
    """Wong, Theory of Ground Vehicles, 1.3: (w r - v) / max(|w r|, |v|), at most 1 in magnitude."""
    linear, angular = np.zeros((2, 3, twin.model.nv))
    mujoco.mj_jacBody(twin.model, data, linear, angular, body)
    ahead, _, up = (linear @ data.qvel) @ twin.attitude.as_matrix()
    speed = math.copysign(math.hypot(ahead, up), ahead)
    about_axle = ((angular @ data.qvel) @ twin.attitude.as_matrix())[1]
    rim = about_axle * {"leo": 0.0625, "rover_zero4wd": 0.127}[twin.rover.name]
    fastest = max(abs(rim), abs(speed))
    return 0.0 if fastest < STANDING else float(np.clip((rim - speed) / fastest, -1.0, 1.0))


def roughness(twin: Twin, data: mujoco.MjData, bodies: list[int]) -> float:
    """RMS over 0.3 m around each wheel of the height above the mean of 0.3 m around."""
    ground = twin.world.ground
    width = 2 * int(0.3 / 2 / ground.cell) + 1
    above = ground.heights - uniform_filter(ground.heights, width)
    squares = uniform_filter(above**2, width)
    columns, rows = np.rint((data.xpos[bodies, :2] + ground.half_size).T / ground.cell).astype(int)
    return math.sqrt(squares[rows, columns].mean())


def contact(twin: Twin) -> Expected:
    """std_msgs/Bool."""
    return {"data": bool(forces(twin, "hazard"))}


def traversal(twin: Twin) -> Expected:
    """std_msgs/Float64MultiArray; the label names the values."""
    data, bodies = twin.at_present(), [int(wheel.bodyid[0]) for wheel in twin.wheels]
    values = {
        "contact_force": max(forces(twin, "hazard"), default=0.0),
        "rock_contact": float(bool(forces(twin, "rock"))),
        "scrape": float(bool(forces(twin, "scrape"))),
        "speed": twin.attitude.inv().apply(twin.data.qvel[:3])[0],
        "path_length": twin.path_length,
        "slip_front_left": slip(twin, data, bodies[0]),
        "slip_rear_left": slip(twin, data, bodies[1]),
        "slip_front_right": slip(twin, data, bodies[2]),
        "slip_rear_right": slip(twin, data, bodies[3]),
        "roughness": roughness(twin, data, bodies),
    }
    dimension = {"label": ",".join(values), "size": len(values), "stride": len(values)}
    return {"layout": {"dim": [dimension], "data_offset": 0}, "data": list(values.values())}


def person(twin: Twin) -> Expected:
    """geometry_msgs/Pose of somebody who looks where they go."""
    looks = Rotation.from_euler("z", -90, degrees=True)
    return {"position": vector(twin.person), "orientation": quaternion(looks)}


def topics() -> tuple[Topic, ...]:
    """Every topic, in the order in which those of one tick go out."""
    tf2, sensor = "tf2_msgs/msg/TFMessage", "sensor_msgs/msg"
    moving = 50, 20  # whenever anything else is told
    once: dict[str, Any] = {"rates": ((), ()), "depth": 1, "latched": True}

    def clock(twin: Twin) -> Expected:
        return {"clock": stamp(twin.time_ns)}

    rows = (
        ("/scan", f"{sensor}/LaserScan", 20, scan),
        ("/imu/data", f"{sensor}/Imu", 20, imu),
        ("/rover/pose_array", "geometry_msgs/msg/PoseArray", 50, pose_array),
        ("/odometry/wheels", "nav_msgs/msg/Odometry", (20, 50), wheel_odometry()),
        ("/odom_ground_truth", "nav_msgs/msg/Odometry", 50, ground_truth),
        ("/joint_states", f"{sensor}/JointState", 50, joint_states),
        ("/rover/truth/contact", "std_msgs/msg/Bool", 20, contact),
        ("/rover/truth/traversal", "std_msgs/msg/Float64MultiArray", 20, traversal),
        ("/lidar2d/scan", f"{sensor}/LaserScan", 5, ranging.planar_scan),
        ("/lidar3d/points", f"{sensor}/PointCloud2", 5, ranging.lidar_points),
        ("/depth/image", f"{sensor}/Image", 5, ranging.depth_image),
        ("/depth/camera_info", f"{sensor}/CameraInfo", 5, ranging.depth_info),
        ("/depth/points", f"{sensor}/PointCloud2", 5, ranging.depth_points),
        ("/gnss/fix", f"{sensor}/NavSatFix", 5, surroundings.fix),
        ("/imu/mag", f"{sensor}/MagneticField", 20, surroundings.magnetic_field),
        ("/barometer/pressure", f"{sensor}/FluidPressure", 10, surroundings.pressure),
        ("/height_scan/grid_map", "grid_map_msgs/msg/GridMap", 20, surroundings.grid_map),
        ("/guide_actor/pose", "geometry_msgs/msg/Pose", 30, person),
        ("/clock", "rosgraph_msgs/msg/Clock", 100, clock),
    )
    of_float32 = {"/scan": 1e-5, "/lidar2d/scan": 1e-5, "/height_scan/grid_map": 2e-6}
    return (
        Topic("/robot_description", "std_msgs/msg/String", expect=described, **once),
        Topic("/tf_static", tf2, expect=tf_static, **once),
        Topic("/tf", tf2, (moving, moving), tf, depth=100),
        *(
            Topic(
                name,
                kind,
                rates if isinstance(rates, tuple) else (rates, rates),
                expect,
                reliable=name != "/rover/pose_array",
                tolerance=of_float32.get(name, EXACT),
            )
            for name, kind, rates, expect in rows
        ),
    )


def differences(message: Any, expected: Expected, tolerance: float, path: str) -> list[str]:  # noqa: ANN401
    """Fields, by their paths, that are not as expected, or that nobody has an expectation of."""
    found = []
    for field in fields_of(message):
        place = f"{path}.{field}"
        if field not in expected:
            found.append(f"{place}: nobody asserts it")
        else:
            found += _different(getattr(message, field), expected[field], tolerance, place)
    found += [f"{path}.{field}: no such field" for field in expected if not hasattr(message, field)]
    return found


def fields_of(message: Any) -> list[str]:  # noqa: ANN401 - of rclpy, or of rosbags
    """The names of its fields."""
    if is_dataclass(message):
        return [f.name for f in fields(message) if not f.name.startswith("__")]
    return list(message.get_fields_and_field_types())


def _different(value: Any, expected: Any, tolerance: float, place: str) -> list[str]:  # noqa: ANN401
    if callable(expected):
        return [] if expected(value) else [f"{place}: {value}, should be {expected}"]
    if isinstance(expected, Mapping):
        return differences(value, expected, tolerance, place)
    if isinstance(expected, list) and expected and isinstance(expected[0], Mapping):
        pairs = enumerate(zip(value, expected, strict=False))
        found = [] if len(value) == len(expected) else [f"{place}: {len(value)} elements"]
        return found + [d for i, (v, e) in pairs for d in differences(v, e, tolerance, f"{place}[{i}]")]
    if isinstance(expected, float):
        same = value == expected or abs(value - expected) <= EXACT + EXACT * abs(expected)
    elif isinstance(expected, str | bool | int) or (len(expected) and isinstance(expected[0], str)):
        same = type(value) is type(expected) and value == expected
    else:
        array = np.asarray(value)
        same = len(array) == len(expected) and np.allclose(array, expected, EXACT, tolerance)
    return [] if same else [f"{place}: {value}, should be {expected}"]
