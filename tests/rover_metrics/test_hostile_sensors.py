"""The node against sensors that are broken, and the fuzz: each message is survived and accounted for.

The fuzz calls the callbacks as the executor does; tests/e2e/test_hostile_domain.py goes through DDS.
"""

import array
import gc
import math
import random
import sys
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from geometry_msgs.msg import Pose, PoseArray
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, LaserScan

from rover_metrics.core.metrics import WINDOW
from rover_metrics.health.watches import JUMPED_AHEAD, MISSING, STANDS_STILL, WENT_BACK
from rover_metrics.topics import SENSORS

if TYPE_CHECKING:
    from rover_metrics.metrics_node import MetricsNode
    from tests.rover_metrics.conftest import Rig

pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")

SCAN, IMU, POSE, ODOMETRY = SENSORS
LIMITS = (0.15, 10.0)
NAN, INF = math.nan, math.inf
ODD_FLOATS = (NAN, INF, -INF, 0.0, -0.0, -1.0, 1e-300, 1e300, -1e308, 1e5, 427.0, 9.8)
MESSAGES = 50_000


def remarks(node: "MetricsNode", topic: str) -> dict[str, int]:
    return {what: count for what, count in node.reception.remarks[topic].items() if what != "no stamp"}


# Scans


def test_a_scan_of_a_hundred_thousand_beams_comes_through_dds(rig: "Rig") -> None:
    node = rig.start()
    rig.publisher(LaserScan, "scan").publish(rig.scan(*(7.0,) * 99_999, 3.5, limits=LIMITS))
    rig.spin_until(lambda: node.received["/scan"] == 1)
    assert node.metrics.clearance == 3.5


# IMU, pose, odometry


# Stamps


def test_stamps_that_stand_still_go_back_jump_or_leave_gaps_are_counted(rig: "Rig") -> None:
    node = rig.start()
    give = partial(node.take, IMU)
    for number in range(20):
        give(rig.imu((0.0, 0.0, 9.8), stamp=10 + number / 20))
    node.reception.look(0, 0)
    for stamp in (11.0, 11.0, 10.5, 10.55, 3610.0, 3610.05, 3610.25):
        give(rig.imu((0.0, 0.0, 9.8), stamp=stamp))
    assert remarks(node, "/imu/data") == {STANDS_STILL: 1, WENT_BACK: 1, JUMPED_AHEAD: 1, MISSING: 3}
    assert node.metrics.smoothness_metric == pytest.approx(27 * 9.8)
    assert node.reception.rejected["/imu/data"] == 0


# Fuzz


class Fuzz:
    """Random messages of the four topics, from a seed; the message objects are reused."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)  # noqa: S311 - no secrets here
        self._scan, self._imu, self._odometry, self._poses = LaserScan(), Imu(), Odometry(), PoseArray()
        self._pose = Pose()
        self._ranges = [
            array.array("f", [self._range() for _ in range(size)]) for size in (0, 1, 2, 7, 64) * 8
        ]

    def message(self) -> tuple[str, Any]:
        topic = self.random.choice(("scan", "imu/data", "rover/pose_array", "odometry/wheels"))
        make = {
            "scan": self._random_scan,
            "imu/data": self._random_imu,
            "rover/pose_array": self._random_poses,
            "odometry/wheels": self._random_odometry,
        }[topic]
        message = make()
        stamp = message.header.stamp
        stamp.sec = self.random.choice((0, 1, 100, -(2**31), 2**31 - 1, stamp.sec))
        stamp.nanosec = self.random.randrange(2**32)
        return topic, message

    def _range(self) -> float:
        return self.random.choice((NAN, INF, -INF, 0.0, -1.0, 0.1, 0.2, 5.0, 11.0, 3e38))

    def _float(self) -> float:
        if self.random.random() < 0.3:
            return self.random.choice(ODD_FLOATS)
        return self.random.gauss(0.0, 10.0)

    def _fill(self, vector: Any) -> None:  # noqa: ANN401 - a message
        vector.x, vector.y, vector.z = self._float(), self._float(), self._float()

    def _random_scan(self) -> LaserScan:
        self._scan.ranges = self.random.choice(self._ranges)
        self._scan.range_min = abs(self._range())
        self._scan.range_max = abs(self._range())
        return self._scan

    def _random_imu(self) -> Imu:
        self._fill(self._imu.linear_acceleration)
        self._fill(self._imu.angular_velocity)
        return self._imu

    def _random_poses(self) -> PoseArray:
        self._fill(self._pose.position)
        self._poses.poses = [self._pose] * self.random.choice((0, 1, 1, 1, 3))
        return self._poses

    def _random_odometry(self) -> Odometry:
        self._fill(self._odometry.twist.twist.linear)
        return self._odometry


def test_fifty_thousand_random_messages_do_no_harm_and_leave_nothing_behind(rig: "Rig") -> None:
    node = rig.start(stale_after=0.0)
    fuzz, sources = Fuzz(7), {source.name: source for source in SENSORS}

    def give(messages: int) -> None:
        for number in range(messages):
            topic, message = fuzz.message()
            node.take(sources[f"/{topic}"], message)
            if number % 1000 == 0:
                node.periodic_logging()
                node.reception.look(number * 10**9, 5 * 10**9)

    give(MESSAGES // 5)
    gc.collect()
    before = sys.getallocatedblocks()
    give(MESSAGES)
    gc.collect()
    assert sys.getallocatedblocks() - before < 1000
    assert sum(node.received.values()) == MESSAGES + MESSAGES // 5
    row = node.last_row
    assert row is not None
    assert all(math.isfinite(float(cell)) for cell in row.as_fields()[:-1])
    rejected = node.reception.rejected
    assert all(0 < count < node.received[topic] for topic, count in rejected.items() if count)
    assert rejected["/scan"] == 0
    assert len(node.metrics._smoothness) == WINDOW
    assert node.lost_rows == 0
