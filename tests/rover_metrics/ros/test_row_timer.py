"""Clocks that are reset, jump, fight or stand still, against the real node over real DDS."""

import csv
import json
from datetime import datetime
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

from rover_metrics.metrics_node import MetricsNode
from rover_metrics.topics import SENSORS
from tests.rover_metrics.conftest import Rig

Capsys = pytest.CaptureFixture[str]

SCAN, IMU, POSE, ODOMETRY = SENSORS
SECOND = 10**9


class SimClock:
    """A simulator's clock; each time is served before the next is told."""

    def __init__(self, rig: Rig, node: MetricsNode) -> None:
        self._rig, self._node = rig, node
        self._publisher = rig.publisher(Clock, "/clock")

    def tell(self, *seconds: float) -> None:
        for second in seconds:
            now_ns = round(second * SECOND)
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(now_ns, SECOND)
            self._publisher.publish(message)
            self._rig.spin_until(lambda now_ns=now_ns: self._is(now_ns))  # type: ignore[misc]

    def _is(self, now_ns: int) -> bool:
        shows = self._node.get_clock().now().nanoseconds == now_ns
        return shows and not self._node.timer._timer.is_ready()


@pytest.fixture
def node(rig: Rig) -> Any:  # noqa: ANN401 - rclpy has no types
    return rig.start(use_sim_time=True)


@pytest.fixture
def clock(rig: Rig, node: MetricsNode) -> SimClock:
    return SimClock(rig, node)


def stamps(node: MetricsNode) -> list[int]:
    with node.log.path.open(newline="") as file:
        return [int(row["Timestamp"]) for row in csv.DictReader(file)]


def tenths(start: float, end: float) -> list[float]:
    return [tenth / 10 for tenth in range(round(start * 10), round(end * 10) + 1)]


def test_a_restart_begins_a_segment(rig: Rig, node: MetricsNode, clock: SimClock, capfd: Capsys) -> None:
    clock.tell(*tenths(0.1, 3.4))
    node.take(SCAN, rig.scan(0.1))
    clock.tell(0.0, *tenths(0.1, 3.5))
    assert stamps(node) == [1, 2, 3, 1, 2, 3]
    assert node.timer.times.segments == 2
    assert node.last_row is not None
    assert node.metrics.total_collisions == 1
    told = capfd.readouterr().err
    assert told.count("the clock went back: segment 2 of this log begins, totals go on") == 1


def test_a_jump_of_an_hour_is_one_row_and_no_burst(node: MetricsNode, clock: SimClock) -> None:
    clock.tell(*tenths(0.1, 2.5), *tenths(3602.5, 3604.0))
    assert stamps(node) == [1, 2, 3602, 3603, 3604]
    assert node.timer.times.segments == 1


def test_a_clock_that_stands_still_is_told_once(
    node: MetricsNode, clock: SimClock, capfd: Capsys
) -> None:
    clock.tell(0.5)
    for steady in range(20):
        node.timer.look((10 + steady) * SECOND)
    clock.tell(0.6)
    node.timer.look(30 * SECOND)
    told = capfd.readouterr().err
    assert told.count("ROS time has stood still at 0.50 s for 5 s: no rows are written") == 1
    assert told.count("ROS time goes on after") == 1


def test_system_time_that_is_set_back_takes_no_row_with_it(rig: Rig) -> None:
    node = rig.start()
    timer = node.timer._timer
    timer.timer_period_ns = 3600 * SECOND
    timer.reset()  # now its next call is as far away as if the clock had been set back by an hour
    timer.timer_period_ns = SECOND
    rig.spin_until(lambda: node.timer.times.segments == 2)  # it is looked after by steady time
    assert timer.time_until_next_call() <= SECOND
    node.timer.look(SECOND)
    assert node.timer.times.segments == 2
    rig.spin_until(lambda: node.rows == 1)


def test_a_second_publisher_is_told(rig: Rig, capfd: Capsys) -> None:
    node = rig.start()
    second = [rig.simulator.create_publisher(LaserScan, "scan", 10) for _ in range(2)][1]
    for _ in range(2):
        rig.simulator.create_publisher(Clock, "/clock", 10)  # which nobody here follows
    rig.spin_until(lambda: node.count_publishers("/scan") == node.count_publishers("/clock") == 2)
    node.timer._fire()
    rig.simulator.destroy_publisher(second)
    rig.spin_until(lambda: node.count_publishers("/scan") == 1)
    node.timer._fire()
    told = capfd.readouterr().err
    assert told.count("/scan: 2 publishers, whose messages mix in this log; stop all but one") == 1
    assert told.count("/scan: no second publisher any more") == 1
    assert "/clock" not in told
    assert "[WARN]" in told


def test_a_second_clock_is_told(rig: Rig, node: MetricsNode, clock: SimClock, capfd: Capsys) -> None:
    rig.simulator.create_publisher(Clock, "/clock", 10)
    rig.spin_until(lambda: node.count_publishers("/clock") == 2)
    clock.tell(2.0)
    assert "/clock: 2 publishers" in capfd.readouterr().err


def test_the_record_tells_the_end_and_the_account(rig: Rig, node: MetricsNode) -> None:
    record = node.log.path.with_suffix(".json")
    assert json.loads(record.read_text())["outcome"] is None
    node.take(IMU, rig.imu((float("nan"), 0.0, 0.0), stamp=1.0))
    node.set_parameters([Parameter("collision_threshold", value=0.75)])
    node.timer.times.went_back()
    node.fail("ValueError: boo")
    rig.end(node)
    told = json.loads(record.read_text())
    assert told["outcome"] == {"status": "failed", "reason": "ValueError: boo"}
    assert told["thresholds"]["collision_threshold"] == 0.75
    counted = {"received": 1, "rejected": 1, "lost": 0, "remarks": {"not finite": 1}}
    assert told["topics"]["/imu/data"] == counted
    assert (told["rows"], told["lost_rows"], told["segments"]) == (0, 0, 2)
    assert datetime.fromisoformat(told["ended"]) == datetime.fromisoformat(told["started"])
