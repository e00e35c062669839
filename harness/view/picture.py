"""Command: draw a recorded episode.

    python -m harness.view.picture RECORDING --picture FILE.png --video FILE.mp4 [--lidar]

`harness.run --picture` starts it after the run, in a process of its own: OpenGL without a display must
be chosen before MuJoCo is imported, and no run is to wait for its pictures.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import mujoco
from PIL import Image
from scipy.signal import lfilter

from harness.errors import HarnessError
from harness.files import whole_file
from harness.view.camera import View, best_view, chase_view
from harness.view.stage import Quality
from harness.view.states import States
from harness.view.studio import Studio

SCALE = 2  # a picture of 1280 x 640 is drawn twice as large: edges and shadows get smooth
QUALITY = Quality(width=SCALE * 1280, height=SCALE * 640, samples=4, shadow_map=8192, slices=28)
KEPT_BITS = 0xFC  # of each colour: the last two are noise that doubles the file
VIDEO_QUALITY = Quality(width=960, height=480, samples=2, shadow_map=2048, slices=16)
FRAME_RATE = 25  # [Hz], the recording's
MOST_FRAMES = 250  # 10 s: a longer run is played faster, so that no video takes minutes to draw
TURN_TIME = 2.0  # [s] that the camera takes to follow a turn


def draw_picture(recording: Path, target: Path, *, lidar: bool) -> None:
    """Draws the end of a recording with the path that led there, as PNG."""
    with Studio(recording, QUALITY, lidar=lidar) as studio:
        states = studio.recording
        studio.pose(-1)
        view = best_view(studio.model, studio.data, states.path, states.yaw[-1], studio.half_width)
        image = Image.fromarray(studio.image(-1, view)).reduce(SCALE)
    with whole_file(target) as part:
        image.point(lambda value: value & KEPT_BITS).save(part, format="PNG", optimize=True)


def draw_video(recording: Path, target: Path, *, lidar: bool) -> None:
    """Draws a recording as H.264 in MP4: the camera follows the rover, the path grows behind it."""
    import av  # noqa: PLC0415 - its extra may be missing

    with Studio(recording, VIDEO_QUALITY, lidar=lidar) as studio, whole_file(target) as part:
        count = len(studio.recording.times)
        frames = range(0, count, -(-count // MOST_FRAMES))
        views = _chase(studio.recording)
        with av.open(str(part), "w", format="mp4") as container:
            stream = container.add_stream("libx264", rate=FRAME_RATE, options={"crf": "23"})
            stream.width, stream.height = VIDEO_QUALITY.width, VIDEO_QUALITY.height
            stream.pix_fmt = "yuv420p"
            for index in frames:
                image = av.VideoFrame.from_ndarray(studio.image(index, views[index]), format="rgb24")
                container.mux(stream.encode(image))
            container.mux(stream.encode())


def _chase(recording: States) -> list[View]:
    """A view from behind at each state; by a low-pass it turns more calmly than the rover."""
    share = 1.0 / (TURN_TIME * FRAME_RATE)
    calm, _ = lfilter([share], [1.0, share - 1.0], recording.yaw, zi=(1.0 - share) * recording.yaw[:1])
    return [chase_view(place, yaw) for place, yaw in zip(recording.path, calm.tolist(), strict=True)]


def probe() -> None:
    """Makes and drops an OpenGL context; raises whatever MuJoCo does if there is none."""
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    mujoco.Renderer(model, 16, 16).close()


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        if options.recording is None:
            probe()
            return 0
        if options.picture is not None:
            draw_picture(options.recording, options.picture, lidar=options.lidar)
        if options.video is not None:
            draw_video(options.recording, options.video, lidar=options.lidar)
    except (HarnessError, OSError) as error:
        print(f"harness.view.picture: {error}", file=sys.stderr)
        return error.exit_code if isinstance(error, HarnessError) else 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m harness.view.picture",
        description="Draws a recorded episode; without a recording, only tries out OpenGL.",
        epilog="MUJOCO_GL=egl or osmesa chooses OpenGL without a display.",
    )
    parser.add_argument("recording", type=Path, nargs="?")
    parser.add_argument("--picture", type=Path, metavar="FILE.png")
    parser.add_argument("--video", type=Path, metavar="FILE.mp4")
    parser.add_argument("--lidar", action="store_true", help="show the beams that hit something")
    return parser


if __name__ == "__main__":
    sys.exit(main())
