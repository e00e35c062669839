"""A node in another process, as the services that it answers with: their clients stand in for it."""

import json
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.errors import RunFailed, UsageError
from harness.ros import remote
from harness.ros.remote import RemoteNode


class Rig:
    """A bridge and a node that answers."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.found = self.sim_time = self.counts = self.answers = True
        self.received: dict[str, int] = {"/scan": 3, "/stranger": 9}
        self.asked: list[str] = []
        self.patience: list[float] = []
        self.came_true: list[bool] = []
        self.matched = 0
        scan = SimpleNamespace(get_subscription_count=lambda: self.matched)
        self.bridge: Any = SimpleNamespace(
            get_namespace=lambda: "/rover1/",
            create_client=self._client,
            executor=None,
            channels=[SimpleNamespace(topic="/scan", publisher=scan)],
            count_subscribers={"/scan": 2}.get,
            published=lambda: {"/scan": 9, "/imu/data": 9},
            get_name=lambda: "harness",
            get_node_names_and_namespaces=lambda: [
                ("harness", "/rover1"),
                ("rviz", "/"),
                ("nav", "/rover1"),
            ],
        )
        parameters = SimpleNamespace(
            services_are_ready=lambda: self.found, get_parameters=self._get_parameters
        )

        def client(_: object, name: str) -> SimpleNamespace:
            self.asked.append(name)
            return parameters

        monkeypatch.setattr(remote, "AsyncParameterClient", client)
        monkeypatch.setattr(remote, "spin_until", self._spin_until)

    def _spin_until(self, _: object, condition: Callable[[], bool], patience: float) -> bool:
        self.patience.append(patience)
        if not condition():
            self.matched += 2
        self.came_true.append(condition())
        return self.came_true[-1]

    def _future(self, result: object) -> Any:  # noqa: ANN401 - a future
        return SimpleNamespace(done=lambda: self.answers, result=lambda: result)

    def _get_parameters(self, names: list[str]) -> Any:  # noqa: ANN401 - a future
        self.asked += names
        return self._future(SimpleNamespace(values=[SimpleNamespace(bool_value=self.sim_time)]))

    def _client(self, _: type, name: str) -> Any:  # noqa: ANN401 - a client
        self.asked.append(name)
        return SimpleNamespace(
            service_is_ready=lambda: self.counts,
            call_async=lambda _: self._future(SimpleNamespace(message=json.dumps(self.received))),
        )

    def node(self, name: str = "metrics_node") -> RemoteNode:
        return RemoteNode(name, self.bridge)


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
    assert rig.asked[:2] == [full, f"{full}/received"]


def test_a_node_counts_as_there_when_its_subscriptions_have_matched(rig: Rig) -> None:
    rig.node()
    assert rig.matched == 2
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


def test_both_barriers_ask_and_a_node_that_does_not_answer_fails_the_run(rig: Rig) -> None:
    node = rig.node()
    for barrier in (node.wait_for_samples, lambda: node.wait_for_clock(5)):
        rig.answers, asked = True, len(rig.asked)
        barrier()
        assert rig.asked[asked:] == ["use_sim_time"]
        rig.answers = False
        with pytest.raises(RunFailed, match=r"^/rover1/metrics_node stopped answering$"):
            barrier()


def test_received_are_those_of_this_runs_topics_since_the_start(rig: Rig) -> None:
    node = rig.node()
    rig.received = {"/scan": 10, "/imu/data": 4, "/stranger": 20}
    assert node.received(1.5) == {"/scan": 7, "/imu/data": 4}
    assert rig.patience[-1] == 1.5


def test_a_node_that_does_not_count_or_hangs_has_received_nothing_known(rig: Rig) -> None:
    node = rig.node()
    rig.answers = False
    assert node.received() == {}
    rig.answers, rig.counts = True, False
    assert node.received() == {}


@pytest.mark.parametrize("told", [["/scan"], "text", {"/scan": "many"}, {"/scan": None}])
def test_a_service_of_that_name_that_is_another_ones_has_received_nothing_known(
    rig: Rig,
    told: Any,  # noqa: ANN401 - not what a MetricsNode tells
) -> None:
    rig.received = told
    assert rig.node().received() == {}
