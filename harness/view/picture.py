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

from harness.errors import HarnessError
from harness.files import whole_file
from harness.view.camera import best_view
from harness.view.stage import Quality
from harness.view.studio import Studio

SCALE = 2  # a picture of 1280 x 640 is drawn twice as large: edges and shadows get smooth
QUALITY = Quality(width=SCALE * 1280, height=SCALE * 640, samples=4, shadow_map=8192, slices=28)
KEPT_BITS = 0xFC  # of each colour: the last two are noise that doubles the file


def draw_picture(recording: Path, target: Path, *, lidar: bool) -> None:
    """Draws the end of a recording with the path that led there, as PNG."""
    with Studio(recording, QUALITY, lidar=lidar) as studio:
        states = studio.recording
        studio.pose(-1)
        view = best_view(studio.model, studio.data, states.path, states.yaw[-1], studio.half_width)
        image = Image.fromarray(studio.image(-1, view)).reduce(SCALE)
    with whole_file(target) as part:
        image.point(lambda value: value & KEPT_BITS).save(part, format="PNG", optimize=True)


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
            from harness.view.video import draw_video  # noqa: PLC0415 - its extra may be missing

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
