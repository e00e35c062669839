"""rover/metrics over real DDS, with somebody who listens."""

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")
pytest.importorskip("diagnostic_msgs", reason="needs ros-diagnostic-msgs")

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock

from rover_metrics.metrics_node import MetricsNode
from rover_metrics.ros import metrics_publisher
from rover_metrics.topics import SENSORS
from tests.rover_metrics.conftest import Rig

Capsys = pytest.CaptureFixture[str]
Patch = pytest.MonkeyPatch

SCAN = SENSORS[0]
Heard = list[Any]


def listen(rig: Rig, node: MetricsNode, topic: str = "rover/metrics") -> Heard:
    """What arrives from now on."""
    heard: Heard = []
    rig.simulator.create_subscription(DiagnosticArray, topic, heard.append, 10)
    rig.spin_until(lambda: node.publisher.listeners == 1)
    return heard


def tick(rig: Rig, node: MetricsNode, clock: Any, *seconds: int) -> None:  # noqa: ANN401
    """Let time reach each of some seconds, and its row be written."""
    for second in seconds:
        rows, message = node.rows, Clock()
        message.clock.sec = second
        clock.publish(message)
        rig.spin_until(lambda rows=rows: node.rows > rows)  # type: ignore[misc]


def test_each_row_is_published_with_levels_and_a_topic_that_stops_goes_stale(rig: Rig) -> None:
    node = rig.start("-r", "__ns:=/leo", use_sim_time=True, stale_after=2.0, min_safe_clearance=0.1)
    heard = listen(rig, node)
    clock = rig.publisher(Clock, "/clock")
    for second in range(1, 5):
        if second < 3:
            node.take(SCAN, rig.scan(0.15, 3.0, stamp=second - 0.25))
        tick(rig, node, clock, second)
    rig.spin_until(lambda: len(heard) == 4)
    assert [message.header.stamp.sec for message in heard] == [1, 2, 3, 4]
    statuses = [{status.name: status for status in message.status} for message in heard]
    topics = ("scan", "imu data", "rover pose_array", "odometry wheels")
    named = {f"metrics_node: {t}" for t in ("traversal metrics", *(f"topic leo {t}" for t in topics))}
    assert set(statuses[0]) == named
    traversal = [each["metrics_node: traversal metrics"] for each in statuses]
    scan = [each["metrics_node: topic leo scan"] for each in statuses]
    assert {status.hardware_id for each in statuses for status in each.values()} == {"leo"}
    assert traversal[0].level == DiagnosticStatus.ERROR
    assert "min_safe_clearance" not in traversal[0].message
    assert {pair.key: pair.value for pair in traversal[1].values}["Total Collisions"] == "2"
    assert [status.level for status in scan] == [DiagnosticStatus.OK] * 3 + [DiagnosticStatus.STALE]
    assert {pair.key: pair.value for pair in scan[3].values}["age [s]"] == "2.2500"
    assert statuses[0]["metrics_node: topic leo imu data"].level == DiagnosticStatus.STALE


def test_an_error_while_publishing_costs_no_row(rig: Rig, capfd: Capsys, monkeypatch: Patch) -> None:
    node = rig.start(use_sim_time=True)
    heard = listen(rig, node)
    clock = rig.publisher(Clock, "/clock")

    def broken(*_: object) -> None:
        raise RuntimeError("the middleware\nis gone")

    with monkeypatch.context() as patch:
        patch.setattr(node.publisher, "_message", broken)
        tick(rig, node, clock, 1, 2, 3)
    tick(rig, node, clock, 4)
    rig.spin_until(lambda: len(heard) == 1)
    told = capfd.readouterr().err
    assert "cannot publish rover/metrics: RuntimeError: the middleware is gone (1 so far)" in told
    assert told.count("cannot publish") == 2  # the 1st and the 2nd time
    assert len(node.log.path.read_bytes().splitlines()) == 5


def test_publishing_can_be_switched_and_waits_for_listeners(rig: Rig, monkeypatch: Patch) -> None:
    node = rig.start(use_sim_time=True)
    clock = rig.publisher(Clock, "/clock")
    with monkeypatch.context() as patch:
        patch.setattr(node, "_statuses", None)  # calling it would be told
        tick(rig, node, clock, 1)
    assert node.publisher._failures == 0
    heard = listen(rig, node)
    for second, switch in ((2, False), (3, True)):
        assert node.set_parameters_atomically([Parameter("publish_metrics", value=switch)]).successful
        tick(rig, node, clock, second)
    rig.spin_until(lambda: len(heard) == 1)
    assert heard[0].header.stamp.sec == 3


def test_without_diagnostic_msgs_rows_are_written(rig: Rig, capfd: Capsys, monkeypatch: Patch) -> None:
    monkeypatch.setattr(metrics_publisher, "DiagnosticArray", None)
    node = rig.start(use_sim_time=True)
    tick(rig, node, rig.publisher(Clock, "/clock"), 1)
    assert "rover/metrics is not published: diagnostic_msgs is not installed" in capfd.readouterr().err
    assert node.rows == 1


def test_a_recording_gets_each_message_though_nobody_listens(rig: Rig) -> None:
    node, recorded = rig.start(use_sim_time=True), Heard()
    node.publisher.record = recorded.append
    tick(rig, node, rig.publisher(Clock, "/clock"), 1, 2)
    assert [message.header.stamp.sec for message in recorded] == [1, 2]
    assert {status.hardware_id for status in recorded[0].status} == {"rover"}
