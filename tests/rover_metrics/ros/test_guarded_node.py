"""What a node does with messages and requests that its handlers fail on."""

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Parameter, SetParametersResult
from rcl_interfaces.srv import GetParameters, SetParameters, SetParametersAtomically
from rclpy.exceptions import ParameterNotDeclaredException
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from rover_metrics.errors import LogError
from rover_metrics.health.reception import Reception
from rover_metrics.health.rejections import NO_TIME
from rover_metrics.ros.guarded_node import GuardedNode

if TYPE_CHECKING:
    from tests.rover_metrics.conftest import Rig


class Bench(GuardedNode):
    """A node without ROS, whose handlers can be called."""

    def __init__(self) -> None:
        self.told: list[str] = []
        self.reception = Reception(self.told.append)
        self.ros_is_up = True

    @property
    def context(self) -> SimpleNamespace:
        return SimpleNamespace(ok=lambda: self.ros_is_up)

    def resolve_topic_name(self, name: str) -> str:
        return f"/ns/{name}"

    resolve_service_name = resolve_topic_name


def failing(error: BaseException) -> Any:  # noqa: ANN401 - a handler
    def handler(*_: object) -> None:
        raise error

    return handler


@pytest.mark.parametrize(
    ("error", "name"),
    [
        (ValueError("a\n b"), "ValueError"),
        (OverflowError("a b"), "OverflowError"),
        (KeyError("a b"), "KeyError"),
        (ParameterNotDeclaredException("a b"), "ParameterNotDeclaredException"),
    ],
)
def test_a_message_that_fails_is_left_out_counted_by_its_kind_and_told_with_the_reason(
    error: Exception, name: str
) -> None:
    node = Bench()
    node._hear("scan", failing(error), object())
    node._hear("scan", failing(error), object())
    assert node.reception.account() == {
        "/ns/scan": {"received": None, "rejected": 2, "lost": 0, "remarks": {f"fails with {name}": 2}}
    }
    assert [line.startswith(f"/ns/scan: fails with {name}: ") for line in node.told] == [True, True]
    assert [line.endswith("left out (1 so far)") for line in node.told] == [True, False]
    assert "\n" not in "".join(node.told)
    assert node.reception.states() == [], "what is not listened to has no state"


@pytest.mark.parametrize("error", [LogError("disk"), RuntimeError("shut down"), KeyboardInterrupt()])
def test_what_a_signal_or_a_shutdown_raises_goes_through(error: BaseException) -> None:
    node = Bench()
    with pytest.raises(type(error)):
        node._hear("scan", failing(error), object())
    with pytest.raises(type(error)):
        node._answer("received", failing(error), Trigger.Request(), Trigger.Response())
    assert node.reception.account() == {}


def test_once_ros_is_down_every_failure_goes_through() -> None:
    node = Bench()
    node.ros_is_up = False
    with pytest.raises(AttributeError):
        node._hear("scan", failing(AttributeError("handle")), object())


@pytest.mark.parametrize(
    ("sec", "nanosec", "heard"),
    [
        *((0, 0, True), (7, 10**9 - 1, True), (2**31 - 1, 0, True)),
        *((-1, 0, False), (-(2**31), 5, False), (7, 10**9, False), (0, 2**32 - 1, False)),
    ],
)
def test_a_clock_tells_a_time_or_is_left_out(sec: int, nanosec: int, heard: bool) -> None:
    node = Bench()
    times: list[Clock] = []
    message = Clock(clock=Time(sec=sec, nanosec=nanosec))
    node._hear_time("clock", times.append, message)
    assert times == [message] * heard
    remarks = {topic: dict(odd) for topic, odd in node.reception.remarks.items()}
    assert remarks == ({} if heard else {"/ns/clock": {NO_TIME: 1}})


def test_who_asks_in_vain_is_answered_with_the_reason() -> None:
    node, error = Bench(), ValueError("77 is\n no type")

    def half(_: object, response: Any) -> None:  # noqa: ANN401 - messages
        response.results.append(SetParametersResult(successful=True))
        raise error

    wishes = [Parameter(name=name) for name in "abc"]
    some = node._answer("s", half, SetParameters.Request(parameters=wishes), SetParameters.Response())
    assert [(each.successful, each.reason) for each in some.results] == [
        (True, ""),
        *[(False, "77 is no type")] * 2,
    ]
    all_or_none = SetParametersAtomically.Request(parameters=wishes)
    whole = node._answer("a", failing(error), all_or_none, SetParametersAtomically.Response())
    assert (whole.result.successful, whole.result.reason) == (False, "77 is no type")
    trigger = node._answer("t", failing(error), Trigger.Request(), Trigger.Response())
    assert (trigger.success, trigger.message) == (False, "77 is no type")
    other = node._answer("g", failing(error), GetParameters.Request(), GetParameters.Response())
    assert other == GetParameters.Response()
    assert set(node.reception.rejected) == {"/ns/s", "/ns/a", "/ns/t", "/ns/g"}


def test_the_clock_is_guarded_again_after_simulated_time_was_switched_off_and_on(rig: "Rig") -> None:
    from rclpy.parameter import Parameter as Value  # noqa: PLC0415 - another Parameter

    node = rig.start(use_sim_time=True)
    for sim_time in (False, True):
        node.set_parameters([Value("use_sim_time", value=sim_time)])
    (clock,) = [each for each in node.subscriptions if each.topic_name == "/clock"]
    publisher = rig.publisher(Clock, "/clock")
    for sec in (5, -1, 6):  # at once: one does not take the place of another
        publisher.publish(Clock(clock=Time(sec=sec)))
    rig.spin_until(lambda: node.get_clock().now().nanoseconds == 6 * 10**9)
    assert dict(node.reception.remarks["/clock"]) == {NO_TIME: 1}
    assert (clock.qos_profile.depth, clock.qos_profile.reliability.name) == (10, "BEST_EFFORT")
