"""Images and camera_info as a listener reads them; images only while there is one, and an OpenGL."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import CameraInfo, Image

from harness.ros.camera import camera_info_fill, image_fill, painter
from harness.ros.channel import Channel
from harness.sensors.camera.sensor import CameraOptions, CameraState
from harness.spec.rover import RoverSetup
from harness.spec.run import Run

STATE = CameraState(12_000_000_345, "eye", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), np.zeros(3))
PIXELS = np.arange(90, dtype=np.uint8).reshape(5, 6, 3)
EYE = CameraOptions(name="eye", width=6, height=5, fov=1.0)


def heard(message: Any) -> Any:  # noqa: ANN401 - rclpy's classes have no types
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (12, 345)
    return deserialize_message(serialize_message(message), type(message))


def test_an_image_is_what_was_drawn_row_by_row() -> None:
    fill = image_fill(Image(), EYE, lambda state: PIXELS if state is STATE else None)
    told = heard(fill(STATE))
    assert (told.height, told.width, told.step) == (5, 6, 18)
    assert (told.encoding, told.is_bigendian, bytes(told.data)) == ("rgb8", 0, bytes(range(90)))


@pytest.mark.parametrize(
    ("lens", "model", "focal"),
    [("pinhole", "plumb_bob", 3 / np.tan(0.5)), ("fisheye", "equidistant", 6)],
)
def test_camera_info_is_the_lens(lens: str, model: str, focal: float) -> None:
    options = CameraOptions(name="eye", width=6, height=5, fov=1.0, lens=lens)
    told = heard(camera_info_fill(CameraInfo(), options)(STATE))
    assert (told.height, told.width, told.distortion_model) == (5, 6, model)
    assert told.d.tolist() == [0.0] * {"plumb_bob": 5, "equidistant": 4}[model]
    k = np.array([[focal, 0, 2.5], [0, focal, 2], [0, 0, 1]])
    assert told.k.reshape(3, 3) == pytest.approx(k)
    assert told.p.reshape(3, 4) == pytest.approx(np.hstack([k, np.zeros((3, 1))]))
    assert told.r.tolist() == np.eye(3).ravel().tolist()


@pytest.mark.parametrize(
    ("listeners", "recorded", "drawn"), [(0, False, 0), (1, False, 2), (0, True, 2)]
)
def test_an_image_is_drawn_while_somebody_listens_or_records(
    listeners: int, recorded: bool, drawn: int
) -> None:
    drew: list[CameraState] = []

    def draw(state: CameraState) -> Any:  # noqa: ANN401 - an image
        drew.append(state)
        return PIXELS

    sent: list[object] = []
    publisher = SimpleNamespace(publish=sent.append, get_subscription_count=lambda: listeners)
    channel = Channel(publisher, image_fill(Image(), EYE, draw), "/image", on_demand=True)
    if recorded:
        channel.record = serialize_message
    for _ in range(2):
        channel.publish(STATE)
    assert (len(drew), len(sent), channel.published) == (drawn,) * 3


@pytest.mark.parametrize("draw", [None, lambda _: None])
def test_without_an_image_nothing_is_published(draw: Any) -> None:  # noqa: ANN401 - a function or None
    publisher = SimpleNamespace(publish=None, get_subscription_count=lambda: 1)
    channel = Channel(publisher, image_fill(Image(), EYE, draw), "/image", on_demand=True)
    channel.publish(STATE)
    assert channel.published == 0


def test_a_run_has_a_painter_of_its_cameras_alone() -> None:
    run = Run.of(sensors=("camera=small", "gnss"), seed=4)
    subject = painter(run)
    assert [camera.width for camera in subject._cameras.values()] == [160]
    assert subject._seed == 4
    other = RoverSetup(robot="rover_zero4wd", name="b", start=(2.0, 1.0, 0.5))
    assert painter(run.but(rovers=(run.rover, other)), 1)._seed != 4
