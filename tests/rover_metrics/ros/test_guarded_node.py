"""What a node does with messages and requests that its handlers fail on, over real DDS."""

from functools import partial
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter as Value
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from rover_metrics.errors import LogError
from rover_metrics.health.rejections import NO_TIME
from rover_metrics.plugins import Table
from rover_metrics.ros.guarded_node import CLOCKS
from rover_metrics.topics import SENSORS
from tests.rover_metrics.conftest import Rig


def failing(error: BaseException) -> Any:  # noqa: ANN401 - a handler
    def handler(*_: object) -> None:
        raise error

    return handler


@pytest.mark.parametrize("error", [ValueError("a\n b"), OverflowError("a b"), KeyError("a b")])
def test_a_message_that_fails_is_counted_and_told(
    rig: Rig, error: Exception, capfd: pytest.CaptureFixture[str]
) -> None:
    node, name = rig.start("-r", "__ns:=/leo"), type(error).__name__
    heard = node.create_subscription(Clock, "broken", failing(error), 10)
    node._hear("broken", failing(error), heard)
    node._hear("broken", failing(error), heard)
    assert node.reception.account()["/leo/broken"] == {
        "received": None,
        "rejected": 2,
        "lost": 0,
        "remarks": {f"fails with {name}": 2},
    }
    (first,) = [line for line in capfd.readouterr().err.splitlines() if "(1 so far)" in line]
    assert f"/leo/broken: fails with {name}: " in first
    assert len(node.reception.states()) == len(SENSORS), "what is not listened to has no state"


def test_an_odd_message_ends_no_plugin_of_a_node_but_a_plugin_that_fails_on_each_message_does(
    rig: Rig, tmp_path: Path
) -> None:
    (file := tmp_path / "mine.py").write_text("def mine(data):\n    return 1 / len(data)\n")
    work = Table[Any]("works", {}, callable, "a work")[f"{file}:mine"]
    node = rig.start()
    for data in (b"", b"", b"1", b"", b""):
        node._hear("scan", work, data)
    assert node.reception.account()["/scan"]["rejected"] == 4
    with pytest.raises(ZeroDivisionError):
        node._hear("scan", work, b"")


@pytest.mark.parametrize("error", [LogError("disk"), RuntimeError("shut down"), KeyboardInterrupt()])
def test_what_a_signal_or_a_shutdown_raises_goes_through(rig: Rig, error: BaseException) -> None:
    node = rig.start()
    with pytest.raises(type(error)):
        node._hear("scan", failing(error), b"")
    with pytest.raises(type(error)):
        node._answer("received", failing(error), Trigger.Request(), Trigger.Response())
    assert not any(node.reception.rejected.values())
    rig.context.shutdown()  # and then every failure does
    with pytest.raises((AttributeError, RuntimeError)):
        node._hear("scan", failing(AttributeError("handle")), b"")


def test_who_asks_in_vain_is_answered_with_the_reason(rig: Rig) -> None:
    node = rig.start()

    def ask(kind: Any, service: str, request: Any) -> Any:  # noqa: ANN401 - rclpy has no types
        client = rig.simulator.create_client(kind, service)
        rig.spin_until(client.service_is_ready)
        future = client.call_async(request)
        rig.spin_until(future.done)
        return future.result()

    good = Parameter(name="fsync", value=ParameterValue(type=1, bool_value=True))
    bad = [Parameter(name=name, value=ParameterValue(type=77)) for name in ("debug_mode", "stale_after")]
    wishes = {"parameters": [good, *bad]}
    place = "/metrics_node/set_parameters"
    some = ask(SetParameters, place, SetParameters.Request(**wishes)).results
    assert len(some) == 3
    assert not any(result.successful for result in some[1:])
    assert all("77" in result.reason for result in some[1:])
    atomically = SetParametersAtomically.Request(**wishes)
    whole = ask(SetParametersAtomically, f"{place}_atomically", atomically).result
    assert (whole.successful, "77" in whole.reason) == (False, True)
    error = ValueError("77 is\n no type")
    trigger = node._answer("t", failing(error), Trigger.Request(), Trigger.Response())
    assert (trigger.success, trigger.message) == (False, "77 is no type")
    other = node._answer("g", failing(error), GetParameters.Request(), GetParameters.Response())
    assert other == GetParameters.Response()


def test_a_clock_that_is_no_time_is_left_out_also_after_simulated_time_was_off(rig: Rig) -> None:
    node = rig.start(use_sim_time=True)
    for sim_time in (False, True):
        node.set_parameters([Value("use_sim_time", value=sim_time)])
    (clock,) = [each for each in node.subscriptions if each.topic_name == "/clock"]
    publisher = rig.publisher(Clock, "/clock")
    times = [(5, 0), (-1, 0), (-(2**31), 5), (7, 10**9), (0, 2**32 - 1), (5, 10**9 - 1), (6, 0)]
    for sec, nanosec in times:  # at once: one does not take the place of another
        publisher.publish(Clock(clock=Time(sec=sec, nanosec=nanosec)))
    rig.spin_until(lambda: node.get_clock().now().nanoseconds == 6 * 10**9)
    assert dict(node.reception.remarks["/clock"]) == {NO_TIME: 4}
    assert (clock.qos_profile.depth, clock.qos_profile.reliability.name) == (CLOCKS, "BEST_EFFORT")


def test_a_flood_of_bytes_that_are_no_message_is_counted_in_few_lines(
    rig: Rig, capfd: pytest.CaptureFixture[str]
) -> None:
    node = rig.start()
    node.create_subscription(Parameter, "torn", failing(AssertionError()), 10)
    publisher = rig.publisher(Parameter, "/torn")

    def left_out(count: int) -> bool:
        return node.reception.rejected.get("/torn") == count

    for count in range(5, 205, 5):
        for _ in range(5):
            publisher.publish(b"\x00\x01\x00\x00" + b"\xff" * 4)
        rig.spin_until(partial(left_out, count))
    node.destroy_node()
    said = capfd.readouterr().err
    assert "/torn: 200 left out in all" in said
    assert said.count("/torn") < 12
    assert len(said) < 6_000
