"""In which order ticks go out, and who is asked before time goes on; and who else may publish."""

from collections.abc import Sequence

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu as ImuMessage
from sensor_msgs.msg import JointState

from harness.base.errors import UsageError
from harness.ros.bridge import Bridge
from harness.ros.channel import Channel
from harness.samples import Imu, Pose, Tick
from tests.support.ros import Ros

LEVEL = (0.0, 0.0, 0.0, 1.0)
POSE, IMU = Pose(5, (0.1, 0.0, 0.0), LEVEL), Imu(5, LEVEL, (0.0, 0.0, 0.0), (0.0, 0.0, 9.8))


class Witness:
    """A listener that notes what it is asked for, and what has been published by then."""

    def __init__(self, bridge: Bridge) -> None:
        self.bridge, self.seen = bridge, list[tuple[str, list[str], int]]()

    def _note(self, what: str, channels: Sequence[Channel]) -> None:
        total = sum(self.bridge.published().values())
        self.seen.append((what, [channel.topic for channel in channels], total))

    def make_room(self, channels: Sequence[Channel]) -> None:
        self._note("room", channels)

    def wait_for_samples(self, channels: Sequence[Channel]) -> None:
        self._note("samples", channels)

    def wait_for_clock(self, stamp_ns: int) -> None:
        self._note(f"clock {stamp_ns}", ())


@pytest.mark.parametrize("tells_time", [True, False])
def test_samples_of_one_kind_go_out_one_by_one_then_the_clock(ros: Ros, tells_time: bool) -> None:
    bridge: Bridge = ros.bridge()
    first, second = Witness(bridge), Witness(bridge)
    sent = Tick(7, (POSE, POSE, IMU, POSE), tells_time)
    bridge.advance(Tick(5, ()), sent, listeners=(first, second))
    pose, both = ["/rover/pose_array"], ["/rover/pose_array", "/imu/data"]
    expected = [("room", both, 0), ("samples", both, 2)]
    expected += [("room", pose, 2), ("samples", pose, 3), ("room", pose, 3), ("samples", pose, 4)]
    assert first.seen == second.seen == expected + [("clock 7", [], 5)] * tells_time
    assert (bridge.time_ns, bridge.commands.clock_ns) == (5, 7 * tells_time)


@pytest.mark.parametrize(("crowded", "kind"), [("/imu/data", ImuMessage), ("/clock", Clock)])
def test_a_second_publisher_of_what_is_heard_or_of_the_clock_is_refused(
    ros: Ros, crowded: str, kind: type
) -> None:
    bridge = ros.bridge()
    ros.node("another").create_publisher(JointState, "/joint_states", 10)
    ros.until(lambda: bridge.count_publishers("/joint_states") == 2)
    bridge.refuse_other_publishers(["/scan", "/imu/data"])
    ros.node("intruder").create_publisher(kind, crowded, 10)
    ros.until(lambda: bridge.count_publishers(crowded) == 2)
    with pytest.raises(UsageError, match=f"^{crowded} has a second publisher"):
        bridge.refuse_other_publishers(["/scan", "/imu/data"])
