"""One node of `--wait-for`: found, asked, counted, let go."""

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.base.errors import RunFailed, UsageError
from harness.episode.result import TopicCount
from harness.ros.remote import counted_by, wait_for_answers
from tests.support.remote_nodes import Rig


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
    assert rig.asked == [f"{full}/get_parameters", f"{full}/received", f"{full}/lock_step True"]


def test_a_node_counts_as_there_when_its_subscriptions_have_matched(rig: Rig) -> None:
    rig.node()
    assert rig.matched >= 2
    assert all(rig.came_true)
    assert min(rig.patience[:1] + rig.patience[2:]) >= 10.0, "a loaded machine is slow"


def test_a_first_answer_that_is_lost_before_dds_has_matched_is_asked_for_again(rig: Rig) -> None:
    rig.lost = 2
    rig.node()
    assert rig.asked[:3] == ["/rover1/metrics_node/get_parameters"] * 3


def test_a_node_that_is_not_there_or_on_wall_time_is_refused_with_the_mend(rig: Rig) -> None:
    rig.sim_time = False
    with pytest.raises(UsageError, match="runs on wall time; start it with -p use_sim_time:=true"):
        rig.node()
    rig.found = False
    with pytest.raises(UsageError, match=r"was not found; running: /rover1/nav, /rviz$"):
        rig.node()
    rig.bridge.get_fully_qualified_node_names = lambda: ["/rover1/harness"]
    with pytest.raises(UsageError, match=r"running: none \(same ROS_DOMAIN_ID"):
        rig.node()


def test_a_node_that_does_not_answer_fails_the_run(rig: Rig) -> None:
    one, other = rig.node("/a"), rig.node("/b")
    rig.silent = "/b/get_parameters"
    with pytest.raises(RunFailed, match=r"^/b stopped answering$"):
        wait_for_answers({one: one.ask(), other: other.ask()}, rig.bridge.executor)
    assert (one.waited_s, other.waited_s) == (1.0, 0.0)
    rig.asked.clear()
    assert other.release() == {}
    assert rig.asked == [], "it is not waited for once more"
    assert one.release()
    with pytest.raises(RunFailed, match=r"^/b stopped answering$"):
        rig.node("/b")
    rig.found, began = False, rig.now
    with pytest.raises(RunFailed, match=r"^/a has ended$"):
        wait_for_answers({one: one.ask()}, rig.bridge.executor)
    assert rig.now == began


def test_received_are_those_of_this_runs_topics_since_the_start_and_the_node_is_let_go(rig: Rig) -> None:
    node = rig.node()
    rig.asked.clear()
    rig.received = {"/scan": 10, "/imu/data": 4, "/stranger": 20}
    assert node.release(1.5) == {"/scan": 7, "/imu/data": 4}
    assert rig.patience[-2:] == [1.5, 1.5]
    assert rig.asked == ["/rover1/metrics_node/received", "/rover1/metrics_node/lock_step False"]


def test_of_a_topic_as_many_are_lost_as_the_one_who_heard_least_lacks(rig: Rig) -> None:
    nodes = [rig.node(), rig.node()]
    rig.received = {"/scan": 12}
    told = {"/scan": TopicCount(published=9, received=4, lost=5)}  # by the run's own node
    assert counted_by(nodes, told)["/scan"].lost == 5
    assert counted_by(nodes, {"/scan": TopicCount(11)})["/scan"].lost == 2


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
