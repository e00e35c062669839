"""/cmd_vel in both types: what is taken, counted and refused, and which type is heard."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from tests.support.waiting import PATIENCE

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

import rclpy
from geometry_msgs.msg import Twist, TwistStamped

from harness.episode.result import CommandCount
from harness.ros.bridge import COMMAND_FRAMES
from harness.ros.commands import STAMPED_BY_DEFAULT, Commands
from harness.ros.context import make_executor, ros_context, spin_until
from harness.samples import Twist as Command

NAN = float("nan")


class Rig:
    """A node that only remembers; `takes_both` says whether a topic may have two types."""

    def __init__(self, *, takes_both: bool) -> None:
        self.takes_both, self.is_in_use = takes_both, False
        self.callbacks: dict[type, Callable[[Any], object]] = {}
        self.sent: list[str] = []  # the types of the publishers
        self.said: list[str] = []
        self.taken: list[Command] = []
        logger = SimpleNamespace(info=self.said.append, warning=lambda line, **_: self.said.append(line))
        self.node: Any = SimpleNamespace(
            resolve_topic_name=lambda name: f"/{name}",
            create_subscription=self._create,
            destroy_subscription=lambda each: self.callbacks.pop(each.kind),
            count_publishers=lambda _: len(self.sent),
            get_publishers_info_by_topic=lambda _: [
                SimpleNamespace(topic_type=f"geometry_msgs/msg/{kind}") for kind in self.sent
            ],
            get_logger=lambda: logger,
        )

    def _create(self, kind: type, _: str, callback: Callable[[Any], object], __: object) -> Any:  # noqa: ANN401
        if (self.callbacks and not self.takes_both) or self.is_in_use:
            raise rclpy.impl.implementation_singleton.rclpy_implementation.RCLError("another type")
        self.callbacks[kind] = callback
        return SimpleNamespace(kind=kind, get_publisher_count=lambda: self.sent.count(kind.__name__))

    def commands(self, kind: str) -> Commands:
        return Commands(self.node, kind, COMMAND_FRAMES, self.taken.append)

    @property
    def heard(self) -> set[str]:
        return {kind.__name__ for kind in self.callbacks}


def stamped(linear: float, frame: str = "", at_ns: int = 0) -> TwistStamped:
    message = TwistStamped()
    message.header.frame_id, message.twist.linear.x = frame, linear
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(at_ns, 1_000_000_000)
    return message


@pytest.mark.parametrize(
    ("kind", "takes_both", "heard"),
    [
        ("twist", True, {"Twist"}),
        ("stamped", True, {"TwistStamped"}),
        ("auto", True, {"Twist", "TwistStamped"}),
        ("auto", False, {"TwistStamped" if STAMPED_BY_DEFAULT else "Twist"}),
        ("auto_twist", False, {"Twist"}),
    ],
)
def test_auto_hears_both_types_where_it_can_and_else_that_of_the_distribution(
    kind: str, takes_both: bool, heard: set[str]
) -> None:
    rig = Rig(takes_both=takes_both)
    rig.commands(kind)
    assert rig.heard == heard


def test_auto_changes_over_to_the_type_that_alone_is_sent_and_complains_once_of_two() -> None:
    rig = Rig(takes_both=False)
    commands = rig.commands("auto")
    (first,), second = commands.heard, "twist" if STAMPED_BY_DEFAULT else "stamped"
    rig.sent = ["Twist" if second == "twist" else "TwistStamped"]
    looks: list[tuple[bool, tuple[str, ...]]] = []
    for _ in range(4):
        rig.is_in_use = len(looks) < 2  # the former subscription, while the executor has not spun
        looks.append((commands.look_around(), commands.heard))
    assert looks == [(False, ()), (False, ()), (True, (second,)), (True, (second,))]
    told, rig.sent = len(rig.said), []
    assert commands.look_around()
    rig.sent = ["Twist", "TwistStamped"]
    assert all(commands.look_around() for _ in range(3))
    assert commands.heard == (second,)
    (line,) = rig.said[told:]
    assert line.startswith("/cmd_vel is also sent as geometry_msgs/msg/Twist")
    assert line.endswith(f"choose with --cmd-vel {first}")


def test_a_type_that_was_chosen_stays_and_what_it_misses_is_told_with_the_mend() -> None:
    rig = Rig(takes_both=True)
    commands = rig.commands("stamped")
    rig.sent = ["Twist"]
    assert all(commands.look_around() for _ in range(2))
    assert rig.heard == {"TwistStamped"}
    (line,) = rig.said
    assert line.endswith("send one type, or choose with --cmd-vel twist")


def test_stamped_commands_older_than_the_present_are_taken_and_counted() -> None:
    rig = Rig(takes_both=True)
    commands = rig.commands("stamped")
    commands.told_ns = 1_500_000_000
    for at_ns in (1_499_999_999, 1_500_000_000, 2_000_000_000, 0):
        rig.callbacks[TwistStamped](stamped(0.1 * at_ns / 1e9, at_ns=at_ns))
    assert [round(command.linear, 3) for command in rig.taken] == [0.15, 0.15, 0.2, 0.0]
    assert commands.count == CommandCount(taken=4, older=2)


@pytest.mark.parametrize("frame", ["", "base_link", "rover1/base_footprint", "odom"])
def test_commands_in_the_rovers_frame_and_as_nav2_stamps_them_are_taken(frame: str) -> None:
    rig = Rig(takes_both=True)
    commands = rig.commands("stamped")
    rig.callbacks[TwistStamped](stamped(0.25, frame))
    assert (rig.taken, commands.count, rig.said) == ([Command(0.25)], CommandCount(1), [])


def test_commands_that_are_not_finite_or_in_another_frame_are_refused_by_name() -> None:
    rig = Rig(takes_both=True)
    commands = rig.commands("auto")
    rig.callbacks[TwistStamped](stamped(0.25, "map"))
    rig.callbacks[TwistStamped](stamped(NAN, "base_link"))
    twist = Twist()
    twist.angular.z = NAN
    rig.callbacks[Twist](twist)
    assert (rig.taken, commands.count) == ([], CommandCount(refused=3))
    assert rig.said == [
        "ignored a command in the frame 'map' on /cmd_vel: give one of "
        + ", ".join((*COMMAND_FRAMES, "or none")),
        "ignored a non-finite command on /cmd_vel: linear.x = nan, angular.z = 0.0",
        "ignored a non-finite command on /cmd_vel: linear.x = 0.0, angular.z = nan",
    ]


@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("kind", ["twist", "stamped"])
def test_whatever_type_another_process_sends_over_dds_drives_the_rover(kind: str) -> None:
    taken: list[Command] = []
    with ros_context([]) as context, ros_context([]) as other, make_executor(context) as executor:
        node = rclpy.create_node("harness", context=context)
        executor.add_node(node)
        commands = Commands(node, "auto", COMMAND_FRAMES, taken.append)
        sender = rclpy.create_node("agent", context=other)
        publisher = sender.create_publisher(
            {"twist": Twist, "stamped": TwistStamped}[kind], "cmd_vel", 10
        )

        def matches() -> bool:
            commands.look_around()
            return bool(publisher.get_subscription_count() > 0)

        assert spin_until(executor, matches, PATIENCE)
        message = stamped(0.5)
        publisher.publish(message.twist if kind == "twist" else message)
        assert spin_until(executor, lambda: bool(taken), PATIENCE)
        for each in (node, sender):
            each.destroy_node()
    assert taken == [Command(0.5)]


def test_commands_are_recorded_as_they_come_until_nobody_records() -> None:
    rig = Rig(takes_both=False)
    commands, recorded = rig.commands("twist"), list[object]()
    message = Twist()
    rig.callbacks[Twist](message)
    commands.record(lambda topic, _: lambda heard: recorded.append((topic, heard)))
    rig.callbacks[Twist](message)
    commands.record(None)
    rig.callbacks[Twist](message)
    assert recorded == [("/cmd_vel", message)]
    assert commands.count.taken == 3
