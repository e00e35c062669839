"""Somebody who does as Nav2's nodes do: their transform buffer, their QoS, their stamped commands."""

import math
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from scipy.spatial.transform import Rotation, Slerp
from sensor_msgs.msg import LaserScan

from harness.base.message_types import typestore
from harness.episode.batch import Batch
from harness.ros.context import make_executor, ros_context, spin_until
from harness.ros.foreign_type import forget_missing_definition, message_type
from tests.support.waiting import PATIENCE

Pose = tuple[Rotation, NDArray[np.float64]]
Place = tuple[float, float]
TF = "tf2_msgs/msg/TFMessage"
DISCOVERY = 0.5  # [s]; for so long it waits after each batch until it has heard everything once
CACHE_NS = 10 * 10**9  # tf2_ros::Buffer
TOLERANCE_NS = 3 * 10**8  # transform_tolerance of a costmap
SPEED, TURN, LOOKAHEAD, TURN_FIRST = 0.6, 1.5, 0.4, 0.785  # [m/s], [rad/s], [m], [rad]
XY_TOLERANCE = 0.2  # [m]
RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
LATCHED = DurabilityPolicy.TRANSIENT_LOCAL


class Buffer:
    """Transforms as tf2 keeps them: interpolated between two stamps, never extrapolated, for 10 s."""

    def __init__(self) -> None:
        self._parents: dict[str, str] = {}
        self._fixed: dict[str, Pose] = {}
        self._moving: dict[str, dict[int, Pose]] = {}

    @property
    def is_connected(self) -> bool:
        """Whether both topics have been heard."""
        return bool(self._fixed and self._moving)

    def take(self, data: bytes, *, fixed: bool) -> None:
        """Keeps what a TFMessage says."""
        message: Any = typestore().deserialize_cdr(data, TF)
        for one in message.transforms:
            child, t, r = one.child_frame_id, one.transform.translation, one.transform.rotation
            pose = Rotation.from_quat([r.x, r.y, r.z, r.w]), np.array([t.x, t.y, t.z])
            self._parents[child] = one.header.frame_id
            if fixed:
                self._fixed[child] = pose
                continue
            stamps = self._moving.setdefault(child, {})
            stamp = one.header.stamp.sec * 10**9 + one.header.stamp.nanosec
            stamps[stamp] = pose
            for old in [each for each in stamps if each < max(stamps) - CACHE_NS]:
                del stamps[old]

    def look_up(self, target: str, source: str, stamp_ns: int | None = None) -> Pose | None:
        """Returns where a frame is in one above it, None where tf2 would throw.

        Args:
            target: The frame above.
            source: The frame.
            stamp_ns: When; None: the latest time that is common to all transforms between them.
        """
        chain = []
        while source != target:
            if source not in self._parents:
                return None
            chain.append(source)
            source = self._parents[source]
        if stamp_ns is None:
            stamp_ns = self.latest(chain)
        rotation, translation = Rotation.identity(), np.zeros(3)
        for frame in chain:
            step = self._at(frame, stamp_ns)
            if step is None:
                return None
            rotation, translation = step[0] * rotation, step[0].apply(translation) + step[1]
        return rotation, translation

    def latest(self, frames: Sequence[str]) -> int:
        """Returns the latest time [ns] that these frames have in common."""
        return min((max(self._moving[frame]) for frame in frames if frame in self._moving), default=0)

    def _at(self, frame: str, stamp_ns: int) -> Pose | None:
        if frame in self._fixed:
            return self._fixed[frame]
        stamps = self._moving[frame]
        if stamp_ns in stamps:
            return stamps[stamp_ns]
        before, after = ([s for s in stamps if s < stamp_ns], [s for s in stamps if s > stamp_ns])
        if not before or not after:
            return None
        ends = max(before), min(after)
        share = (stamp_ns - ends[0]) / (ends[1] - ends[0])
        (first, start), (last, end) = stamps[ends[0]], stamps[ends[1]]
        turn = Slerp([0.0, 1.0], Rotation.concatenate([first, last]))(share)
        return turn, start + share * (end - start)


class Nav2Client:
    """Drives to goals on straight paths, and acts between two batches of a run.

    Args:
        at_end: Closes what it opens.
        goals: In map [m].

    Attributes:
        reached: The stamp [ns] of the transform by which it found itself at each goal.
        scans: How many came; `late_transforms`: how many of them could not be transformed when they did.
        hits: What they saw, in odom [m], shape (n, 3) each.
        told: How many commands it sent.
        grid: /map.
    """

    def __init__(self, at_end: ExitStack, goals: Sequence[Place]) -> None:
        context = at_end.enter_context(ros_context([]))
        self.executor = at_end.enter_context(make_executor(context))
        self.node = rclpy.create_node("nav2_client", context=context)
        self.executor.add_node(self.node)
        self.buffer, self._goals, self._path = Buffer(), list(goals), list[Place]()
        self.reached, self.hits = list[int](), list[NDArray[np.float64]]()
        self.scans = self.late_transforms = self.told = self._now_ns = 0
        self.grid: Any = None
        self._commands = self.node.create_publisher(TwistStamped, "cmd_vel", 1)
        for topic, fixed, durability in (
            ("tf", False, DurabilityPolicy.VOLATILE),
            ("tf_static", True, LATCHED),
        ):
            self._hear(message_type(TF), topic, self._keeps(fixed=fixed), RELIABLE, 100, durability)
        self._hear(Clock, "/clock", self._tell_time, BEST_EFFORT, 1)
        self._hear(LaserScan, "scan", self._mark, BEST_EFFORT, 50)
        self._hear(OccupancyGrid, "map", self._keep_map, RELIABLE, 1, LATCHED)

    def take(self, _: Batch) -> None:
        """Hears what a batch brought, then sends a command."""
        scans, knew_all = self.scans, self.has_heard_all
        came = spin_until(
            self.executor,
            lambda: self.scans > scans and self.has_heard_all,
            PATIENCE if knew_all else DISCOVERY,
        )
        assert came or not knew_all
        # The map is made when somebody listens; what is latched comes when it is discovered.
        if came:
            self._control()

    @property
    def has_heard_all(self) -> bool:
        """Whether the map and every transform below it have come: no discovery is left to wait for."""
        return self.grid is not None and self.buffer.look_up("map", "base_footprint") is not None

    def is_free(self, place: Place, margin: float) -> bool:
        """Whether nothing on /map is occupied around a place."""
        info, reach = self.grid.info, math.ceil(margin / self.grid.info.resolution)
        column = int((place[0] - info.origin.position.x) / info.resolution)
        row = int((place[1] - info.origin.position.y) / info.resolution)
        cells = np.array(self.grid.data).reshape(info.height, info.width)
        return not cells[row - reach : row + reach + 1, column - reach : column + reach + 1].any()

    def _hear(
        self,
        kind: Any,  # noqa: ANN401 - rclpy's classes have no types
        topic: str,
        callback: Callable[[Any], None],
        reliability: ReliabilityPolicy,
        depth: int,
        durability: DurabilityPolicy = DurabilityPolicy.VOLATILE,
    ) -> None:
        qos = QoSProfile(depth=depth, reliability=reliability, durability=durability)
        self.node.create_subscription(kind, topic, callback, qos, raw=kind is message_type(TF))
        forget_missing_definition()

    def _keeps(self, *, fixed: bool) -> Callable[[bytes], None]:
        def keep(data: bytes) -> None:
            self.buffer.take(data, fixed=fixed)

        return keep

    def _tell_time(self, message: Clock) -> None:
        self._now_ns = message.clock.sec * 10**9 + message.clock.nanosec

    def _keep_map(self, message: OccupancyGrid) -> None:
        self.grid = message

    def _mark(self, scan: LaserScan) -> None:
        """The obstacle layer's message filter, without its patience."""
        self.scans += 1
        stamp_ns = scan.header.stamp.sec * 10**9 + scan.header.stamp.nanosec
        pose = self.buffer.look_up("odom", scan.header.frame_id, stamp_ns)
        if pose is None:
            self.late_transforms += self.buffer.is_connected  # else discovery has not ended
            return
        ranges = np.array(scan.ranges)
        angles = scan.angle_min + scan.angle_increment * np.flatnonzero(np.isfinite(ranges))
        across = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))], axis=1)
        points = ranges[np.isfinite(ranges), None] * across
        self.hits.append(pose[0].apply(points) + pose[1] if len(points) else points)

    def _control(self) -> None:
        """A planner's straight path and a pure pursuit that turns first."""
        pose = self.buffer.look_up("odom", "base_footprint")
        assert pose is not None
        assert self._now_ns - self.buffer.latest(["base_footprint"]) < TOLERANCE_NS
        here = pose[1][:2]
        if not self._path and self._goals:
            self._path = self._plan(here, self._goals.pop(0))
        if self._path and math.dist(here, self._path[-1]) < XY_TOLERANCE:
            self.reached.append(self.buffer.latest(["base_footprint"]))
            self._path = []
        self._send(*self._pursue(pose))

    def _plan(self, here: NDArray[np.float64], goal: Place) -> list[Place]:
        """Every 5 cm, all free on /map; the goal is transformed into odom."""
        frame = self.buffer.look_up("map", "odom")
        assert frame is not None
        end = frame[0].inv().apply(np.array([*goal, 0.0]) - frame[1])[:2]
        steps = math.ceil(math.dist(here, end) / 0.05)
        path = [(float(x), float(y)) for x, y in np.linspace(here, end, steps + 1)]
        assert all(self.is_free(place, margin=0.25) for place in path)
        return path

    def _pursue(self, pose: Pose) -> tuple[float, float]:
        """Linear [m/s] and angular velocity [rad/s]."""
        if not self._path:
            return 0.0, 0.0
        here = pose[1][:2]
        nearest = min(range(len(self._path)), key=lambda i: math.dist(here, self._path[i]))
        self._path = self._path[nearest:]
        carrot = next((p for p in self._path if math.dist(here, p) >= LOOKAHEAD), self._path[-1])
        x, y, _ = pose[0].inv().apply(np.array([*carrot, 0.0]) - [*here, 0.0])
        bearing = math.atan2(y, x)
        if abs(bearing) > TURN_FIRST:
            return 0.0, math.copysign(TURN, bearing)
        return SPEED, float(np.clip(SPEED * 2.0 * y / (x * x + y * y), -TURN, TURN))

    def _send(self, linear: float, angular: float) -> None:
        message = TwistStamped()
        message.header.frame_id = "odom"  # as the pose's, of which pure pursuit takes the header
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(self._now_ns, 10**9)
        message.twist.linear.x, message.twist.angular.z = float(linear), float(angular)
        self._commands.publish(message)
        self.told += 1
