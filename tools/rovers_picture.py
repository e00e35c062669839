"""Makes docs/rovers.webp: both rovers drive side by side, with the camera and the marks of `--video`.

MUJOCO_GL=egl python tools/rovers_picture.py docs/rovers.webp      # or osmesa
"""

import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from harness import Run, run_episode
from harness.physics.stage import Quality
from harness.view.picture import Studio, chase
from harness.view.states import StateWriter

SECONDS, EVERY = 8.0, 3  # of a run; of its states, which come 25 a second
RUNS = (
    Run.of(robot="leo", terrain="rocky", seed=0, duration=SECONDS),
    Run.of(robot="rover_zero4wd", terrain="marsyard", seed=0, duration=SECONDS),
)
IMAGE = Quality(width=420, height=280, samples=4, shadow_map=2048, slices=20)
GAP, COMPRESSION = 4, 60  # [pixels] between the two; quality of WebP, 0 to 100


def film(run: Run, folder: Path) -> Iterator[Image.Image]:
    """Drives, and yields an image of each of the states that are shown."""
    path = folder / run.rover.robot
    with closing(StateWriter(path, run)) as states:
        run_episode(run, folder / "logs", observers=[states])
    with Studio(path, IMAGE, lidar=False) as studio:
        for index, view in list(enumerate(chase(studio.recording)))[::EVERY]:
            yield Image.fromarray(studio.image(index, view))


def main(picture: Path) -> None:
    """Drives both and puts their images beside each other."""
    frames = []
    with TemporaryDirectory() as folder:
        for left, right in zip(*(film(run, Path(folder)) for run in RUNS), strict=True):
            frame = Image.new("RGB", (2 * IMAGE.width + GAP, IMAGE.height), "white")
            frame.paste(left, (0, 0))
            frame.paste(right, (IMAGE.width + GAP, 0))
            frames.append(frame)
    first, *more = frames
    timing = {"duration": 40 * EVERY, "loop": 0}
    first.save(picture, save_all=True, append_images=more, quality=COMPRESSION, method=6, **timing)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
