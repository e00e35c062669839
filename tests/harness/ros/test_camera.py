"""Images and camera_info as a listener reads them; images only while there is one, and an OpenGL."""

from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import CameraInfo, Image

from harness.ros.channel import open_channel
from harness.ros.optional_messages import Draw, camera_info_fill, image_fill
from harness.ros.rover_nodes import painter
from harness.sensors.camera.sensor import CameraOptions, CameraState
from harness.sensors.table import Topic
from harness.spec.rover import RoverSetup
from harness.spec.run import Run
from tests.harness.ros.conftest import Ros

STATE = CameraState(12_000_000_345, "eye", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), np.zeros(3))
PIXELS = np.arange(216, dtype=np.uint8).reshape(8, 9, 3)
EYE = CameraOptions(name="eye", width=9, height=8, fov=1.0)


def heard(message: Any) -> Any:  # noqa: ANN401 - rclpy's classes have no types
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (12, 345)
    return deserialize_message(serialize_message(message), type(message))


def test_an_image_is_what_was_drawn_row_by_row() -> None:
    fill = image_fill(Image(), EYE, lambda state: PIXELS if state is STATE else None)
    told = heard(fill(STATE))
    assert (told.height, told.width, told.step) == (8, 9, 27)
    assert (told.encoding, told.is_bigendian, bytes(told.data)) == ("rgb8", 0, bytes(range(216)))


@pytest.mark.parametrize(
    ("lens", "model", "focal"),
    [("pinhole", "plumb_bob", 4.5 / np.tan(0.5)), ("fisheye", "equidistant", 9)],
)
def test_camera_info_is_the_lens(lens: str, model: str, focal: float) -> None:
    options = EYE.but(lens=lens)
    told = heard(camera_info_fill(CameraInfo(), options)(STATE))
    assert (told.height, told.width, told.distortion_model) == (8, 9, model)
    assert told.d.tolist() == [0.0] * {"plumb_bob": 5, "equidistant": 4}[model]
    k = np.array([[focal, 0, 4], [0, focal, 3.5], [0, 0, 1]])
    assert told.k.reshape(3, 3) == pytest.approx(k)
    assert told.p.reshape(3, 4) == pytest.approx(np.hstack([k, np.zeros((3, 1))]))
    assert told.r.tolist() == np.eye(3).ravel().tolist()


@pytest.mark.parametrize(
    ("listens", "records", "draw", "sent"),
    [
        (False, False, lambda _: PIXELS, 0),
        (True, False, lambda _: PIXELS, 2),
        (False, True, lambda _: PIXELS, 2),
        (True, True, lambda _: None, 0),
        (True, True, None, 0),
    ],
)
def test_an_image_is_drawn_and_sent_while_somebody_wants_it(
    ros: Ros, listens: bool, records: bool, draw: Draw | None, sent: int
) -> None:
    topic = Topic("image", "sensor_msgs/msg/Image", on_demand=True)
    channel = open_channel(ros.node("camera"), topic, image_fill(Image(), EYE, draw))
    if listens:
        ros.node("viewer").create_subscription(Image, "image", lambda _: None, 1)
        ros.until(channel.publisher.get_subscription_count)
    if records:
        channel.record = serialize_message
    for _ in range(2):
        channel.publish(STATE)
    assert channel.published == sent


def test_a_run_has_a_painter_of_its_cameras_alone() -> None:
    run = Run.of(sensors=("camera=small", "gnss"), seed=4)
    subject = painter(run)
    assert [camera.width for camera in subject._cameras.values()] == [160]
    assert subject._seed == 4
    other = RoverSetup(robot="rover_zero4wd", name="b", start=(2.0, 1.0, 0.5))
    assert painter(run.but(rovers=(run.rover, other)), 1)._seed != 4
