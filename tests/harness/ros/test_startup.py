"""What is checked before a run begins, with publishers that only say how many listen."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.errors import UsageError
from harness.ros import startup

TOPICS = ("/scan", "/imu/data", "/joint_states")


def bridge(**listeners: int) -> Any:  # noqa: ANN401 - a stand-in
    def channel(topic: str) -> SimpleNamespace:
        count = listeners.get(topic.strip("/").split("/")[0], 0)
        return SimpleNamespace(
            topic=topic, publisher=SimpleNamespace(get_subscription_count=lambda: count)
        )

    channels = [channel(topic) for topic in (*TOPICS, "/clock")]
    return SimpleNamespace(channels=channels, clock_channel=channels[-1])


@pytest.mark.parametrize(
    ("listeners", "alone"),
    [
        ({"scan": 1, "imu": 2, "clock": 1}, None),
        ({"scan": 1, "imu": 1}, "/clock"),
        ({"clock": 1, "joint_states": 1}, "/scan, /imu/data"),
    ],
)
def test_a_run_waits_for_the_hosted_nodes_topics_and_the_clock(
    listeners: dict[str, int], alone: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        startup, "spin_until", lambda _, condition, patience: patience > 5 and condition()
    )
    if alone is None:
        startup.await_match(bridge(**listeners), None, TOPICS[:2])
        return
    with pytest.raises(UsageError, match=f"DDS did not connect {alone} within 15 s; is ROS_AUTO"):
        startup.await_match(bridge(**listeners), None, TOPICS[:2])


@pytest.mark.parametrize(
    ("crowded", "refused"), [("/imu/data", True), ("/clock", True), ("/joint_states", False)]
)
def test_a_second_publisher_of_what_is_heard_or_of_the_clock_is_refused(
    crowded: str, refused: bool
) -> None:
    node = bridge()
    node.count_publishers = lambda topic: 1 + (topic == crowded)
    if not refused:
        startup.refuse_other_publishers(node, TOPICS[:2])
        return
    with pytest.raises(UsageError, match=f"^{crowded} has a second publisher"):
        startup.refuse_other_publishers(node, TOPICS[:2])


def test_the_hosted_node_runs_on_simulation_time_and_logs_where_it_is_told(
    ros_domain: int, tmp_path: Path
) -> None:
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=ros_domain)
    node = startup.metrics_node(context, tmp_path / "logs")
    assert node.get_parameter("use_sim_time").value is True
    assert node.log.path.parent == tmp_path / "logs"
    node.destroy_node()
    (tmp_path / "file").touch()
    with pytest.raises(UsageError, match="file"):
        startup.metrics_node(context, tmp_path / "file" / "logs")
    context.shutdown()
