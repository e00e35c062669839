"""A recorded episode as a video: the camera follows the rover, the path grows behind it."""

from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from harness.files import whole_file
from harness.view.camera import View, chase_view
from harness.view.stage import Quality
from harness.view.states import States
from harness.view.studio import Studio

QUALITY = Quality(width=960, height=480, samples=2, shadow_map=2048, slices=16)
FRAME_RATE = 25  # [Hz], the recording's
MOST_FRAMES = 250  # 10 s: a longer run is played faster, so that no video takes minutes to draw
TURN_TIME = 2.0  # [s] that the camera takes to follow a turn


def draw_video(recording: Path, target: Path, *, lidar: bool) -> None:
    """Draws a recording as H.264 in MP4."""
    with Studio(recording, QUALITY, lidar=lidar) as studio, whole_file(target) as part:
        frames = shown_states(len(studio.recording.times))
        views = chase(studio.recording, frames)
        with av.open(str(part), "w", format="mp4") as container:
            stream = container.add_stream("libx264", rate=FRAME_RATE, options={"crf": "23"})
            stream.width, stream.height = QUALITY.width, QUALITY.height
            stream.pix_fmt = "yuv420p"
            for index, view in zip(frames, views, strict=True):
                image = av.VideoFrame.from_ndarray(studio.image(index, view), format="rgb24")
                container.mux(stream.encode(image))
            container.mux(stream.encode())


def shown_states(count: int) -> list[int]:
    """Indices of the states that become frames: all, or evenly chosen ones."""
    step = -(-count // MOST_FRAMES)
    return list(range(0, count, step))


def chase(recording: States, frames: list[int]) -> list[View]:
    """A view from behind for each frame; it turns more calmly than the rover."""
    yaw = _calmed(recording.yaw, TURN_TIME * FRAME_RATE)
    return [chase_view(recording.path[index], float(yaw[index])) for index in frames]


def _calmed(values: NDArray[np.float64], samples: float) -> NDArray[np.float64]:
    """A first-order low-pass with a time constant in samples."""
    calmed = np.empty_like(values)
    present = values[0]
    for index, value in enumerate(values):
        present += (value - present) / samples
        calmed[index] = present
    return calmed
