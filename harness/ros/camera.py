"""Images of a camera and what its lens is, as messages."""

from array import array
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.logging import get_logger
from sensor_msgs.msg import CameraInfo, Image

from harness.base.sim_time import NANOSECONDS
from harness.episode.assembly import scenery, sensor_rows
from harness.ros.channel import Fill
from harness.samples import Sample
from harness.sensors.camera.lens import Lens
from harness.sensors.camera.painter import CameraPainter
from harness.sensors.camera.sensor import CameraOptions, CameraState
from harness.spec.run import Run

Draw = Callable[[CameraState], NDArray[np.uint8] | None]  # None: there is no OpenGL
ENCODING, CHANNELS = "rgb8", 3


def painter(run: Run, number: int = 0) -> CameraPainter:
    """Returns what draws for the cameras of a rover; nothing is started before the first image.

    Args:
        run: The run.
        number: The rover's place in it.
    """
    given = (row.given for row in sensor_rows(run.rovers[number]))
    cameras = {options.name: options for options in given if isinstance(options, CameraOptions)}
    return CameraPainter(
        partial(scenery, run), cameras, run.own_seed(number), get_logger("harness").warning
    )


def image_fill(message: Image, options: CameraOptions, draw: Draw | None) -> Fill:
    """Returns a filler that has the image of each sample drawn; None for a message without one."""
    message.encoding, message.is_bigendian = ENCODING, 0
    message.width, message.height = options.width, options.height
    message.step = CHANNELS * options.width

    def fill(state: CameraState) -> Image | None:
        pixels = None if draw is None else draw(state)
        if pixels is None:
            return None
        _stamp(message, state)
        message.data = array("B", pixels.tobytes())
        return message

    return fill


def camera_info_fill(message: CameraInfo, options: CameraOptions) -> Fill:
    """Returns a filler of what is known of the camera's lens."""
    return lens_info(message, options.lens_of())


def lens_info(message: CameraInfo, lens: Lens) -> Fill:
    """Returns a filler of what is known of a lens, which is without further distortion."""
    message.width, message.height = lens.width, lens.height
    message.distortion_model = lens.distortion_model
    message.d = [0.0] * lens.coefficients
    message.k = lens.matrix.ravel()
    message.r = np.eye(3).ravel()
    message.p = np.column_stack([lens.matrix, np.zeros(3)]).ravel()

    def fill(sample: Sample) -> CameraInfo:
        _stamp(message, sample)
        return message

    return fill


def _stamp(message: Any, sample: Sample) -> None:  # noqa: ANN401 - rclpy's classes have no types
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(sample.stamp_ns, NANOSECONDS)
