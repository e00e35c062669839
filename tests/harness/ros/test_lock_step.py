"""When nodes in other processes are asked, and waited for."""

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.ros.lock_step import ROOM, RemoteNodes
from rover_metrics.metrics_node import HOLDS, KEEPS_ORDER, LISTENS_ANEW
from tests.support.remote_nodes import Rig

LATER = NANOSECONDS + TICK_NS


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Rig:
    return Rig(monkeypatch)


def nodes_of(rig: Rig, *names: str, keep_order: str = "") -> RemoteNodes:
    """Nodes of which one may keep order."""
    nodes = []
    for name in names:
        rig.promise = KEEPS_ORDER + HOLDS.format(1, 8) if name == keep_order else ""
        nodes.append(rig.node(name))
    rig.asked.clear()
    return RemoteNodes(nodes, rig.bridge)


def test_several_nodes_are_asked_at_once_and_each_waiting_is_counted(rig: Rig) -> None:
    parts = [rig.node("/a"), rig.node("/b"), rig.node("/c")]
    began = rig.now
    nodes = RemoteNodes(parts, rig.bridge)
    for stamp_ns in (TICK_NS, 2 * TICK_NS):
        rig.asked.clear()
        nodes.wait_for_clock(stamp_ns)
        assert rig.asked_now() == ["/a", "/b", "/c"]
    assert rig.now - began == 2.0, "the three seconds of each tick are one"
    assert [part.waited_s for part in parts] == [2.0, 2.0, 2.0]


def test_after_samples_only_those_are_asked_that_listen_to_them(rig: Rig) -> None:
    rig.readers = [("/", "a"), ("/rover1", "b"), ("/", "stranger")]
    nodes = nodes_of(rig, "/a", "b", "/c")
    rig.matched = 3
    nodes.wait_for_samples([rig.scan])
    assert rig.asked_now() == ["/a", "/rover1/b"]
    rig.matched = 1
    rig.readers = [("/", "stranger")]
    nodes.wait_for_samples([rig.scan])
    assert rig.asked_now() == []


@pytest.mark.parametrize("unknown", ["not in the graph", "_NODE_NAME_UNKNOWN_"])
def test_all_are_asked_as_long_as_a_reader_may_be_anybodys(rig: Rig, unknown: str) -> None:
    nodes = nodes_of(rig, "/a", "/b")
    rig.matched = 2
    rig.readers = [("/", "a"), ("/", unknown)][: 1 if unknown == "not in the graph" else 2]
    for _ in range(2):
        rig.matched = 2
        nodes.wait_for_samples([rig.scan])
        assert rig.asked_now() == ["/a", "/b"]
    rig.readers, rig.matched = [("/", "a"), ("/", "x")], 2
    nodes.wait_for_samples([rig.scan])
    assert rig.asked_now() == ["/a"]


def test_a_reader_that_takes_anothers_place_is_known_a_second_later(rig: Rig) -> None:
    nodes = nodes_of(rig, "/a", "/b")
    rig.matched = 1
    for reader, now_ns, asked in (("a", TICK_NS, "/a"), ("b", 5 * TICK_NS, "/a"), ("b", LATER, "/b")):
        rig.readers, rig.matched, rig.bridge.time_ns = [("/", reader)], 1, now_ns
        nodes.wait_for_samples([rig.scan])
        assert rig.asked_now() == [asked]
        nodes.wait_for_clock(3)  # of a fault that lets it stand still
        rig.asked_now()


def test_who_keeps_order_is_asked_after_the_clock_and_not_waited_for(rig: Rig) -> None:
    nodes = nodes_of(rig, "/a", keep_order="/a")
    rig.readers, rig.matched = [("/", "a")], 1
    began = rig.now
    nodes.make_room([rig.scan])
    nodes.wait_for_samples([rig.scan])
    assert rig.asked_now() == []
    nodes.wait_for_clock(TICK_NS)
    assert rig.asked_now() == ["/a"]
    rig.answer()
    nodes.wait_for_clock(2 * TICK_NS)
    assert (rig.asked_now(), rig.now) == ([], began), "its answer has come meanwhile"
    nodes.make_room([rig.scan])
    assert (rig.asked_now(), rig.now) == ([], began)


def test_before_a_second_message_of_a_topic_its_queue_is_known_to_be_empty(rig: Rig) -> None:
    nodes = nodes_of(rig, "/a", "/b", keep_order="/a")
    rig.readers, rig.matched = [("/", "a"), ("/", "b")], 2
    nodes.wait_for_samples([rig.scan])
    assert rig.asked_now() == ["/b"], "the others are waited for as ever"
    rig.matched = 2
    imu: Any = SimpleNamespace(topic="/imu/data")
    nodes.make_room([imu])
    assert rig.asked_now() == []
    nodes.make_room([rig.scan])
    assert rig.asked_now() == ["/a"]
    nodes.wait_for_samples([rig.scan])
    nodes.wait_for_clock(TICK_NS)
    assert rig.asked_now() == ["/b", "/b", "/a"]


def test_no_more_times_wait_for_a_node_than_its_queue_holds(rig: Rig) -> None:
    nodes = nodes_of(rig, "/a", keep_order="/a")
    began = rig.now
    for tick in range(8):
        nodes.wait_for_clock(tick)
        assert rig.asked_now() == ["/a"] * (tick == 5)
    assert rig.now == began
    nodes.wait_for_clock(8)
    assert (rig.asked_now(), rig.now > began) == ([], True)


@pytest.mark.parametrize(
    ("said", "holds"), [(HOLDS.format(1, 8), 1), (HOLDS.format(4, 8), 4), (" or not", 0)]
)
def test_as_many_messages_wait_as_a_node_says_that_its_queues_hold(
    rig: Rig, said: str, holds: int
) -> None:
    rig.promise = KEEPS_ORDER + said
    subject = rig.node("/a")
    nodes = RemoteNodes([subject], rig.bridge)
    assert subject.keeps_order == (holds > 0)
    for number in range(1, 3 * holds):
        rig.readers, rig.matched = [("/", "a")], 1
        began = rig.now
        nodes.make_room([rig.scan])
        assert (rig.now > began) == (number > holds and (number - 1) % holds == 0)
        nodes.wait_for_samples([rig.scan])


def test_no_more_is_on_its_way_to_a_node_than_a_socket_takes(rig: Rig) -> None:
    rig.promise, rig.scan.size = KEEPS_ORDER + HOLDS.format(98, 98), ROOM // 4
    nodes = RemoteNodes([rig.node("/a")], rig.bridge)
    rig.asked.clear()
    asked, waited = [], []
    for _ in range(5):
        rig.readers, rig.matched, began = [("/", "a")], 1, rig.now
        nodes.make_room([rig.scan])
        waited.append(rig.now > began)
        nodes.wait_for_samples([rig.scan])
        nodes.wait_for_clock(TICK_NS)
        asked.append(rig.asked_now())
    assert asked == [[], [], ["/a"], [], []]
    assert waited == [False, False, False, False, True]


@pytest.mark.parametrize("listens_anew", [True, False])
def test_a_node_that_listens_anew_is_waited_for_until_it_can_hear(rig: Rig, listens_anew: bool) -> None:
    rig.readers, rig.matched = [("/rover1", "metrics_node")], 2
    rig.promise = KEEPS_ORDER + HOLDS.format(98, 98) + LISTENS_ANEW
    rig.listens_anew = listens_anew
    subject = rig.node()
    assert (subject.keeps_order, subject.holds) == (True, 98)
    assert rig.came_true[-1] == listens_anew
