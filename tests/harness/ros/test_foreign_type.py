"""A type that is not installed: bytes that rosbags wrote, under its name and hash."""

from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from sensor_msgs.msg import Imu

from harness.base.message_types import GRID_MAP, typestore
from harness.ros import foreign_type
from harness.ros.context import make_executor, spin_until
from harness.ros.foreign_type import forget_missing_definition, message_type
from rover_metrics.ros.subscriptions import keep_last

TF = "tf2_msgs/msg/TFMessage"
# tf2_msgs of Kilted: what `ros2 topic info -v /tf` shows.
TF_HASH = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
GRID_MAP_HASH = "RIHS01_343b0e72887541beda6b035cc053f2d6fffaad9d6dcb2773c15a808dfca31fde"


def test_a_type_that_is_installed_is_the_installed_one_others_are_those_of_their_packages() -> None:
    assert message_type("sensor_msgs/msg/Imu") is Imu
    assert typestore().hash_rihs01(GRID_MAP) == GRID_MAP_HASH
    assert getattr(message_type(GRID_MAP), "__name__", None) == "GridMap"


def test_bytes_go_under_the_name_and_the_hash_of_a_type_also_to_who_comes_later(
    ros_domain: int, capfd: pytest.CaptureFixture[str]
) -> None:
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain)
    node: Any = rclpy.create_node("talker", context=context)
    kind, qos = message_type(TF), keep_last(1, latched=True)
    publisher = node.create_publisher(kind, "told", qos)
    forget_missing_definition()
    store = typestore()
    data = bytes(store.serialize_cdr(store.types[TF]([]), TF))
    publisher.publish(data)
    heard: list[bytes] = []
    node.create_subscription(kind, "told", heard.append, qos, raw=True)
    forget_missing_definition()
    node.create_publisher(Imu, "imu", 10)
    with make_executor(context) as executor:
        executor.add_node(node)
        assert spin_until(executor, lambda: bool(heard), 20.0)
        (info,) = node.get_publishers_info_by_topic("/told")
    node.destroy_node()
    context.shutdown()
    assert heard == [data]
    assert (info.topic_type, str(info.topic_type_hash)) == (TF, TF_HASH)
    assert "error" not in capfd.readouterr().err, "rmw's complaint would be printed by the next"


@pytest.mark.parametrize(
    ("name", "middleware"),
    [(TF, "rmw_cyclonedds_cpp"), ("tf2_msgs/msg/Nothing", "rmw_fastrtps_cpp")],
)
def test_where_it_cannot_be_made_there_is_none(
    name: str, middleware: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(foreign_type, "get_rmw_implementation_identifier", lambda: middleware)
    message_type.cache_clear()
    assert message_type(name) is None
    message_type.cache_clear()
