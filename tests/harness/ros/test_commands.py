"""/cmd_vel in both types: what is taken, counted and refused, and which type is heard."""

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.utilities import get_rmw_implementation_identifier

from harness.episode.result import CommandCount
from harness.ros.bridge import COMMAND_FRAMES
from harness.ros.commands import STAMPED_BY_DEFAULT, Commands
from harness.ros.context import ros_context
from harness.samples import Twist as Command
from tests.support.ros import Ros

NAN = float("nan")
KINDS = {"twist": Twist, "stamped": TwistStamped}
FAST = get_rmw_implementation_identifier() == "rmw_fastrtps_cpp"  # a topic has one type


class Scene:
    """A node that hears commands, and another process's publishers of them."""

    def __init__(self, ros: Ros, kind: str) -> None:
        self.ros, self.taken = ros, list[Command]()
        self.commands = Commands(ros.node("harness"), kind, COMMAND_FRAMES, self.taken.append)
        self._other = rclpy.create_node("agent", context=ros.at_end.enter_context(ros_context([])))
        ros.at_end.callback(self._other.destroy_node)

    def publisher(self, kind: str) -> Any:  # noqa: ANN401 - rclpy has no types
        return self._other.create_publisher(KINDS[kind], "cmd_vel", 10)


def stamped(linear: float, frame: str = "", at_ns: int = 0) -> TwistStamped:
    message = TwistStamped()
    message.header.frame_id, message.twist.linear.x = frame, linear
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(at_ns, 1_000_000_000)
    return message


@pytest.mark.skipif(not FAST, reason="other middlewares hear both types at once")
def test_a_type_is_heard_as_the_distribution_sends(ros: Ros) -> None:
    assert Scene(ros, "auto").commands.heard == ("stamped" if STAMPED_BY_DEFAULT else "twist",)


@pytest.mark.parametrize("kind", ["twist", "stamped"])
def test_whatever_type_another_process_sends_over_dds_drives_the_rover(ros: Ros, kind: str) -> None:
    scene, recorded = Scene(ros, "auto"), list[object]()
    scene.commands.record(lambda *_: recorded.append)
    publisher = scene.publisher(kind)
    ros.until(lambda: scene.commands.look_around() and publisher.get_subscription_count())
    message = stamped(0.5)
    message.twist.angular.z = 0.25
    publisher.publish(message.twist if kind == "twist" else message)
    ros.until(lambda: scene.taken)
    assert scene.taken == [Command(0.5, 0.25)]
    assert recorded == [message.twist if kind == "twist" else message]
    assert kind in scene.commands.heard


@pytest.mark.skipif(not FAST, reason="other middlewares hear both types at once")
@pytest.mark.parametrize("kind", ["twist", "stamped"])
def test_a_chosen_type_stays_and_what_it_misses_is_said_once_with_the_mend(
    ros: Ros, kind: str, capfd: pytest.CaptureFixture[str]
) -> None:
    scene, (other,) = Scene(ros, kind), set(KINDS) - {kind}
    scene.publisher(other)
    said: list[str] = []

    def complains() -> bool:
        assert scene.commands.look_around()
        said.append(capfd.readouterr().err)
        return "--cmd-vel" in said[-1]

    ros.until(complains)
    assert f"choose with --cmd-vel {other}" in said[-1]
    assert scene.commands.look_around()
    assert scene.commands.heard == (kind,)
    assert "--cmd-vel" not in capfd.readouterr().err


def test_stamped_commands_older_than_the_present_are_taken_and_counted(ros: Ros) -> None:
    scene = Scene(ros, "stamped")
    scene.commands.clock_ns = 1_500_000_000
    for at_ns in (1_499_999_999, 1_500_000_000, 2_000_000_000, 0):
        scene.commands.receive("stamped", stamped(at_ns / 1e9, at_ns=at_ns))
    assert [command.linear for command in scene.taken] == pytest.approx([1.5, 1.5, 2.0, 0.0])
    assert scene.commands.count == CommandCount(taken=4, older=2)


def test_what_the_rover_cannot_follow_is_refused_by_name_and_all_is_recorded(
    ros: Ros, capfd: pytest.CaptureFixture[str]
) -> None:
    scene, recorded = Scene(ros, "stamped"), list[object]()
    commands = scene.commands
    turn = Twist()
    turn.angular.z = NAN
    commands.record(lambda topic, _: lambda heard: recorded.append((topic, heard)))
    frames = ("", "base_link", "rover1/base_footprint", "odom")
    messages = [stamped(0.25, frame) for frame in frames]
    messages += [stamped(0.25, "map"), stamped(NAN, "base_link")]
    for message in messages:
        commands.receive("stamped", message)
    commands.record(None)
    commands.receive("twist", turn)
    assert (scene.taken, commands.count) == ([Command(0.25)] * 4, CommandCount(taken=4, refused=3))
    assert recorded == [("/cmd_vel", message) for message in messages]
    assert commands.refusal.startswith("a command in the frame 'map' on /cmd_vel: give one of base_link")
    assert f"ignored {commands.refusal}" in capfd.readouterr().err
