"""In which order ticks go out, and who is asked before time goes on; and who else may publish."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.base.errors import UsageError
from harness.ros.bridge import Bridge
from harness.samples import Imu, Pose, Tick

LEVEL = (0.0, 0.0, 0.0, 1.0)
POSE, IMU = Pose(5, (0.1, 0.0, 0.0), LEVEL), Imu(5, LEVEL, (0.0, 0.0, 0.0), (0.0, 0.0, 9.8))


class Noted:
    """A bridge, its executor and a listener that only say what is asked of them."""

    def __init__(self) -> None:
        self.said: list[object] = []
        self.executor = self
        self.clock_channel: Any = SimpleNamespace(publish=lambda tick: self.said.append(tick.stamp_ns))
        self.commands = SimpleNamespace(told_ns=0)
        channel = SimpleNamespace(publish=self.said.append)
        self.frames: Any = SimpleNamespace(refuse_rivals=lambda: self.said.append("rivals"))
        self.channels_of = {Pose: [channel], Imu: [channel]}

    def advance(self, tick: Tick, *listeners: "Noted") -> None:
        bridge: Any = self
        Bridge.advance(bridge, Tick(5, ()), tick, listeners=listeners)

    def send(self, *ticks: Tick, **listeners: Any) -> None:  # noqa: ANN401
        Bridge.send(self, *ticks, **listeners)  # type: ignore[arg-type]  # a stand-in

    def tell(self, sent: Tick, **listeners: Any) -> None:  # noqa: ANN401
        Bridge.tell(self, sent, **listeners)  # type: ignore[arg-type]  # a stand-in

    def make_room(self, channels: Sequence[object]) -> None:
        self.said.append(("room", len(channels)))

    def wait_for_samples(self, channels: Sequence[object]) -> None:
        self.said.append(("samples", len(channels)))

    def wait_for_clock(self, stamp_ns: int) -> None:
        self.said.append(("clock", stamp_ns))

    def spin_once(self, timeout_sec: float) -> None:
        self.said.append(("spin", timeout_sec))


@pytest.mark.parametrize("tells_time", [True, False])
def test_samples_of_one_kind_go_out_one_by_one_then_the_clock_if_it_tells_time(tells_time: bool) -> None:
    noted = Noted()
    noted.advance(Tick(7, (POSE, POSE, IMU, POSE), tells_time), noted, noted)
    both = [*2 * [("room", 2)], POSE, IMU, *2 * [("samples", 2)]]
    one = [*2 * [("room", 1)], POSE, *2 * [("samples", 1)]]
    bursts: list[object] = [*both, *one, *one]
    assert noted.said == bursts + [7, ("clock", 7), ("clock", 7)] * tells_time
    assert noted.commands.told_ns == 7 * tells_time


def test_without_listeners_commands_are_served_once_a_tick_without_waiting() -> None:
    noted = Noted()
    noted.advance(Tick(5, (POSE, IMU)))
    assert noted.said == [POSE, IMU, 5, ("spin", 0.0)]


@pytest.mark.parametrize(
    ("crowded", "refused"), [("/imu/data", True), ("/clock", True), ("/joint_states", False)]
)
def test_a_second_publisher_of_what_is_heard_or_of_the_clock_is_refused(
    crowded: str, refused: bool
) -> None:
    node: Any = SimpleNamespace(
        clock_channel=SimpleNamespace(topic="/clock"),
        count_publishers=lambda topic: 1 + (topic == crowded),
    )
    if not refused:
        Bridge.refuse_other_publishers(node, ("/scan", "/imu/data"))
        return
    with pytest.raises(UsageError, match=f"^{crowded} has a second publisher"):
        Bridge.refuse_other_publishers(node, ("/scan", "/imu/data"))
