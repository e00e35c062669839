"""Nodes in other processes, as the services that they answer with: their clients stand in for them."""

import json
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from rclpy.task import Future

from harness.errors import RunFailed, UsageError
from harness.ros import remote
from harness.ros.remote import RemoteNode, RemoteNodes
from harness.sim_time import NANOSECONDS, TICK_NS
from rover_metrics.metrics_node import KEEPS_ORDER


class Rig:
    """A bridge with one topic, and nodes that answer one second after they are asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.found = self.sim_time = self.is_metrics_node = True
        self.promise = ""
        self.silent = ""  # the service that does not answer
        self.received: dict[str, int] = {"/scan": 3, "/stranger": 9}
        self.asked: list[str] = []
        self.patience: list[float] = []
        self.came_true: list[bool] = []
        self.matched = 0
        self.now = 0.0
        self.readers: list[tuple[str, str]] = []  # of /scan: namespace and name
        self._waiting: list[tuple[Any, object]] = []
        scan = SimpleNamespace(get_subscription_count=lambda: self.matched)
        self.scan: Any = SimpleNamespace(topic="/scan", publisher=scan)
        self.bridge: Any = SimpleNamespace(
            get_namespace=lambda: "/rover1/",
            create_client=self._client,
            executor=None,
            channels=[self.scan],
            count_subscribers={"/scan": 2}.get,
            published=lambda: {"/scan": 9, "/imu/data": 9},
            get_name=lambda: "harness",
            get_node_names_and_namespaces=lambda: [
                ("harness", "/rover1"),
                ("rviz", "/"),
                ("nav", "/rover1"),
            ],
            get_subscriptions_info_by_topic=lambda _: [
                SimpleNamespace(node_namespace=space, node_name=name) for space, name in self.readers
            ],
        )
        monkeypatch.setattr(remote, "spin_until", self._spin_until)
        monkeypatch.setattr(time, "monotonic", lambda: self.now)

    def _spin_until(self, _: object, condition: Callable[[], bool], patience: float) -> bool:
        self.patience.append(patience)
        if not condition():
            self.matched += 2
            self.now += 1.0
            waiting, self._waiting = self._waiting, []
            for future, answer in waiting:
                future.set_result(answer)
        self.came_true.append(condition())
        return self.came_true[-1]

    def _client(self, _: type, name: str) -> Any:  # noqa: ANN401 - a client
        def call_async(request: Any) -> Any:  # noqa: ANN401
            data = getattr(request, "data", None)
            self.asked.append(name if data is None else f"{name} {data}")
            future: Any = Future()
            answer = SimpleNamespace(
                values=[SimpleNamespace(bool_value=self.sim_time)],
                message=self.promise if name.endswith("lock_step") else json.dumps(self.received),
            )
            if name != self.silent:
                self._waiting.append((future, answer))
            return future

        def is_ready() -> bool:
            return self.found if name.endswith("/get_parameters") else self.is_metrics_node

        return SimpleNamespace(service_is_ready=is_ready, call_async=call_async)

    def node(self, name: str = "metrics_node", *, time_jumps: bool = False) -> RemoteNode:
        return RemoteNode(name, self.bridge, time_jumps=time_jumps)

    def nodes(self, *names: str) -> RemoteNodes:
        nodes = RemoteNodes([self.node(name) for name in names], self.bridge)
        self.asked.clear()
        return nodes

    def asked_now(self) -> list[str]:
        """Which nodes have been asked for their barrier since the last look."""
        asked, self.asked = self.asked, []
        return [name.removesuffix("/get_parameters") for name in asked]


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Rig:
    return Rig(monkeypatch)


@pytest.mark.parametrize(
    ("name", "full"),
    [("metrics_node", "/rover1/metrics_node"), ("/other/node", "/other/node"), ("a/b", "/rover1/a/b")],
)
def test_a_name_is_below_the_bridges_namespace_unless_it_is_absolute(
    rig: Rig, name: str, full: str
) -> None:
    assert rig.node(name).name == full
    assert rig.asked == [f"{full}/get_parameters", f"{full}/lock_step True", f"{full}/received"]


def test_a_node_counts_as_there_when_its_subscriptions_have_matched(rig: Rig) -> None:
    rig.node()
    assert rig.matched >= 2
    assert all(rig.came_true)
    assert min(rig.patience) >= 10.0, "a loaded machine is slow"


def test_a_node_that_is_not_there_is_refused_with_those_that_are(rig: Rig) -> None:
    rig.found = False
    message = r"node /rover1/metrics_node was not found; running: /rover1/nav, /rviz$"
    with pytest.raises(UsageError, match=message):
        rig.node()
    rig.bridge.get_node_names_and_namespaces = lambda: [("harness", "/rover1")]
    with pytest.raises(UsageError, match=r"running: none \(same ROS_DOMAIN_ID"):
        rig.node()


def test_a_node_on_wall_time_is_refused(rig: Rig) -> None:
    rig.sim_time = False
    with pytest.raises(UsageError, match="runs on wall time; start it with -p use_sim_time:=true"):
        rig.node()


def test_a_node_that_does_not_answer_fails_the_run(rig: Rig) -> None:
    nodes = rig.nodes("/a", "/b")
    rig.silent = "/b/get_parameters"
    with pytest.raises(RunFailed, match=r"^/b stopped answering$"):
        nodes.wait_for_clock(5)
    with pytest.raises(RunFailed, match=r"^/b stopped answering$"):
        rig.node("/b")


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
    nodes = rig.nodes("/a", "b", "/c")
    rig.matched = 3
    nodes.wait_for_samples([rig.scan], clock_follows=True)
    assert rig.asked_now() == ["/a", "/rover1/b"]
    rig.matched = 1
    rig.readers = [("/", "stranger")]
    nodes.wait_for_samples([rig.scan], clock_follows=True)
    assert rig.asked_now() == []


def test_who_keeps_order_is_not_asked_between_samples_and_the_clock_that_follows_them(rig: Rig) -> None:
    rig.promise = KEEPS_ORDER
    ordered = rig.node("/a")
    rig.promise = ""
    nodes = RemoteNodes([ordered, rig.node("/b")], rig.bridge)
    rig.readers, rig.matched = [("/", "a"), ("/", "b")], 2
    rig.asked.clear()
    for clock_follows, asked in ((True, ["/b"]), (False, ["/a", "/b"])):
        rig.matched = 2
        nodes.wait_for_samples([rig.scan], clock_follows=clock_follows)
        assert rig.asked_now() == asked
    nodes.wait_for_clock(TICK_NS)
    assert rig.asked_now() == ["/a", "/b"]


@pytest.mark.parametrize("unknown", ["not in the graph", "_NODE_NAME_UNKNOWN_"])
def test_all_are_asked_as_long_as_a_reader_may_be_anybodys(rig: Rig, unknown: str) -> None:
    nodes = rig.nodes("/a", "/b")
    rig.matched = 2
    rig.readers = [("/", "a"), ("/", unknown)][: 1 if unknown == "not in the graph" else 2]
    for _ in range(2):
        rig.matched = 2
        nodes.wait_for_samples([rig.scan], clock_follows=True)
        assert rig.asked_now() == ["/a", "/b"]
    rig.readers, rig.matched = [("/", "a"), ("/", "x")], 2
    nodes.wait_for_samples([rig.scan], clock_follows=True)
    assert rig.asked_now() == ["/a"]


def test_a_reader_that_takes_anothers_place_is_known_a_second_later(rig: Rig) -> None:
    nodes = rig.nodes("/a", "/b")
    rig.matched = 1
    for reader, until_ns, asked in (("a", TICK_NS, "/a"), ("b", NANOSECONDS, "/a"), ("b", 0, "/b")):
        rig.readers, rig.matched = [("/", reader)], 1
        nodes.wait_for_samples([rig.scan], clock_follows=True)
        assert rig.asked_now() == [asked]
        nodes.wait_for_clock(until_ns)
        rig.asked_now()


def test_received_are_those_of_this_runs_topics_since_the_start_and_the_node_is_let_go(rig: Rig) -> None:
    node = rig.node()
    rig.asked.clear()
    rig.received = {"/scan": 10, "/imu/data": 4, "/stranger": 20}
    assert node.release(1.5) == {"/scan": 7, "/imu/data": 4}
    assert rig.patience[-2:] == [1.5, 1.5]
    assert rig.asked == ["/rover1/metrics_node/received", "/rover1/metrics_node/lock_step False"]


def test_a_node_whose_clock_will_be_set_back_keeps_its_own_executor(rig: Rig) -> None:
    rig.node(time_jumps=True)
    assert not [name for name in rig.asked if "lock_step" in name]


def test_a_node_that_does_not_count_or_hangs_has_received_nothing_known(rig: Rig) -> None:
    node = rig.node()
    rig.asked.clear()
    rig.silent = "/rover1/metrics_node/received"
    assert node.release() == {}
    assert rig.asked == [rig.silent], "it is not waited for twice"
    rig.silent, rig.is_metrics_node = "", False
    assert node.release() == {}


@pytest.mark.parametrize("told", [["/scan"], "text", {"/scan": "many"}, {"/scan": None}])
def test_a_service_of_that_name_that_is_another_ones_has_received_nothing_known(
    rig: Rig,
    told: Any,  # noqa: ANN401 - not what a MetricsNode tells
) -> None:
    rig.received = told
    assert rig.node().release() == {}
