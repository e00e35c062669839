"""Bags -> recordings: commands, joints or wheel odometry, IMU, poses, currents, battery, by type."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from harness.base.errors import UsageError
from harness.robots import RoverSpec
from harness.validate.recordings.recording import Recording, Series, in_order
from harness.validate.recordings.tables import check_turning, in_metres
from rover_metrics.bag.bag_reader import Bag
from rover_metrics.bag.mcap_stream import BagError
from rover_metrics.bag.playback import deserialised
from rover_metrics.core.rotation import yaw
from rover_metrics.timing import NANOSECONDS
from rover_metrics.topics import UNKNOWN, vector

Row = tuple[float, ...]
Take = Callable[[Any, RoverSpec], dict[str, Row]]
# In the names of topics that no real rover has, and of poses where it is not, but is to be.
NEITHER = ("truth", "goal", "initialpose")
EACH = "each wheel"  # a series that no recording has: speeds [rad/s], left ones first
MOST_NAMED = 8  # topics
APART = 1.0  # [s] from which on stamps are of another clock than the recorder's, and do not count


def _twist(message: Any, _: RoverSpec) -> dict[str, Row]:  # noqa: ANN401 - rosbags' classes have no types
    twist = getattr(message, "twist", message)
    return {"commands": (twist.linear.x, twist.angular.z)}


def _joints(message: Any, rover: RoverSpec) -> dict[str, Row]:  # noqa: ANN401
    """The rims' speeds, and the motors' torque along the speed; 0 of a motor that is dragged along."""
    speeds = dict(zip(message.name, message.velocity, strict=False))
    torques = dict(zip(message.name, message.effort, strict=False))
    tied = rover.actuators is not None and rover.actuators.one_motor_a_side
    rims, efforts = list[float](), list[float]()
    for side in (rover.drive.left, rover.drive.right):
        if not all(math.isfinite(speeds.get(name, math.nan)) for name in side):  # a dead encoder: NaN
            return {}
        rims.append(rover.controller_radius * float(np.mean([speeds[name] for name in side])))
        driven = [name for name in side if name in rover.drive.driven and name in torques]
        given = np.array([torques[name] * np.sign(speeds[name]) for name in driven])
        efforts.append(max(float(given.sum()), 0.0) if tied else float(given.clip(0.0).sum()))
    has_efforts = all(name in torques for name in rover.drive.driven)
    each = tuple(float(speeds[name]) for name in rover.drive.left + rover.drive.right)
    return {"wheels": tuple(rims), EACH: each} | ({"torques": tuple(efforts)} if has_efforts else {})


def _imu(message: Any, _: RoverSpec) -> dict[str, Row]:  # noqa: ANN401
    """Nothing of one that says of either that it does not measure it (sensor_msgs/Imu)."""
    w, a = vector(message.angular_velocity), vector(message.linear_acceleration)
    covariances = message.angular_velocity_covariance, message.linear_acceleration_covariance
    is_told = all(any(v) or c[0] != UNKNOWN for v, c in zip((w, a), covariances, strict=True))
    return {"imu": (*w, *a)} if is_told else {}


def _poses(message: Any, _: RoverSpec) -> dict[str, Row]:  # noqa: ANN401
    pose = message.poses[0] if len(getattr(message, "poses", ())) else getattr(message, "pose", None)
    pose = getattr(pose, "pose", pose)
    if pose is None:
        return {}
    p, q = pose.position, pose.orientation
    return {"poses": (p.x, p.y, yaw((q.x, q.y, q.z, q.w)))}


def _odometry(message: Any, rover: RoverSpec) -> dict[str, Row]:  # noqa: ANN401
    twist, half = message.twist.twist, rover.controller_separation / 2
    apart = half * twist.angular.z
    return {"wheels": (twist.linear.x - apart, twist.linear.x + apart)}


def _currents(message: Any, _: RoverSpec) -> dict[str, Row]:  # noqa: ANN401
    return {"currents": tuple(map(float, message.data))} if len(message.data) == 2 else {}


def _battery(message: Any, _: RoverSpec) -> dict[str, Row]:  # noqa: ANN401
    return {"power": (-message.voltage * message.current,)}


# In the order in which they count: the type, a word that the topic's name must have, the series of it.
TAKEN: tuple[tuple[str, str, Take], ...] = (
    ("geometry_msgs/msg/Twist", "cmd", _twist),
    ("geometry_msgs/msg/TwistStamped", "cmd", _twist),
    ("sensor_msgs/msg/JointState", "", _joints),
    ("nav_msgs/msg/Odometry", "wheel", _odometry),
    ("nav_msgs/msg/Odometry", "odom", _odometry),
    ("sensor_msgs/msg/Imu", "", _imu),
    ("geometry_msgs/msg/PoseArray", "pose", _poses),
    ("geometry_msgs/msg/PoseStamped", "", _poses),
    ("geometry_msgs/msg/PoseWithCovarianceStamped", "", _poses),
    ("std_msgs/msg/Float64MultiArray", "current", _currents),
    ("sensor_msgs/msg/BatteryState", "", _battery),
)


def recording_of_bag(path: Path, rover: RoverSpec, chosen: Mapping[str, str] | None = None) -> Recording:
    """Returns what a bag says of a rover: of each series what the first row of TAKEN that has it says.

    Args:
        path: Of a rosbag2 folder, an .mcap or a .db3.
        rover: Whose joints and wheels it tells of.
        chosen: Topics by the names of their series, where TAKEN would take others.

    Raises:
        UsageError: It cannot be read, or what was chosen is not there or tells nothing of its series.
    """
    try:
        with Bag(path) as bag:
            if missing := sorted(set((chosen or {}).values()) - set(bag.topics)):
                raise UsageError(
                    f"{path} has no topic {missing[0]}; it has {', '.join(sorted(bag.topics))}"
                )
            rows, sources = _rows(bag, rover, chosen or {})
            if not rows:
                kinds = [f"{topic} ({kind})" for topic, kind in sorted(bag.topics.items())]
                told = ", ".join(kinds[:MOST_NAMED]) or "none"
                raise UsageError(f"{path}: nothing is read of its topics: {told} (docs/real_rovers.md)")
            _check_encoders(rows.pop(EACH, []), rover, sources)
            problems = tuple(bag.problems)
    except BagError as error:
        raise UsageError(f"{path}: {error}") from error
    if untold := [name for name in chosen or {} if name not in rows]:
        raise UsageError(f"{path}: no {untold[0]} can be read of {sources[untold[0]]}")
    late = _lateness(rows["wheels"]) if "wheels" in rows else 0.0
    series = {name: _timed(some, late) for name, some in rows.items()}
    if "imu" in series:  # ROS has units, but not every driver keeps to them
        series["imu"] = in_metres(series["imu"])
        check_turning(series["imu"][:, 3], f"mend {sources['imu']}, or name another IMU", path)
    if "poses" in series:
        series["poses"][:, 3] = np.unwrap(series["poses"][:, 3])
    sources = {name: topic for name, topic in sources.items() if name in series}
    return Recording(path.name, sources=sources, problems=problems, **series)  # type: ignore[arg-type]  # of series alone


def _check_encoders(rows: list[Row], rover: RoverSpec, sources: Mapping[str, str]) -> None:
    """UsageError if a wheel is said to stand all the time while others turn."""
    moved = np.array([row[2:] for row in rows]).any(axis=0) if rows else np.ones(0, np.bool_)
    if moved.any() and not moved.all() and sources["wheels"] == sources[EACH]:
        wheel = (rover.drive.left + rover.drive.right)[int(moved.argmin())]
        raise UsageError(
            f"{sources[EACH]}: '{wheel}' stands at 0 while others turn: its encoder is dead; give "
            "--topic wheels=TOPIC, of an Odometry"
        )


def _rows(
    bag: Bag, rover: RoverSpec, chosen: Mapping[str, str]
) -> tuple[dict[str, list[Row]], dict[str, str]]:
    """By series: stamp (NaN without one), time of recording and values of each message; its topic."""
    takes, named = dict[str, Take](), set(chosen.values())
    for kind, word, take in TAKEN:
        for topic in sorted(t for t, k in bag.topics.items() if k == kind and (word in t or t in named)):
            if topic in named or not any(word in topic for word in NEITHER):
                takes.setdefault(topic, take)
    rows: dict[str, list[Row]] = {}
    source: dict[str, str] = dict(chosen)
    ranked = {topic: rank for rank, topic in enumerate(takes)}
    for message in bag.messages(takes):
        if message.topic not in takes:
            continue
        read = deserialised(message.data, bag.topics[message.topic])
        if read is None:
            continue
        header, now = getattr(read, "header", None), message.time_ns / NANOSECONDS
        stamp = header.stamp.sec + header.stamp.nanosec / NANOSECONDS if header is not None else 0.0
        for name, row in takes[message.topic](read, rover).items():
            before = source.setdefault(name, message.topic)
            if name not in chosen and ranked[message.topic] < ranked[before]:
                source[name], rows[name] = message.topic, []
            if source[name] == message.topic:
                rows.setdefault(name, []).append((stamp or np.nan, now, *row))
    return rows, source


def _lateness(rows: list[Row]) -> float:
    """How much later the recorder's clock is than stamps [s]; 0 where those are of another clock."""
    late = np.array([recorded - stamp for stamp, recorded, *_ in rows])
    near = np.abs(late) < APART
    return float(np.median(late[near])) if near.mean() > 0.5 else 0.0


def _timed(rows: list[Row], late: float) -> Series:
    """Values by their stamps, or where those are of another clock by their recording less `late`."""
    table = np.array(rows)
    stamps, recorded = table[:, 0], table[:, 1]
    near = np.abs(stamps - recorded) < APART
    times = stamps if near.mean() > 0.5 else recorded - late
    whole = np.column_stack([times, table[:, 2:]])
    return in_order(whole[np.isfinite(whole).all(axis=1) & (near if times is stamps else True)])
