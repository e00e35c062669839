"""Draws a recorded episode, as a process of its own that harness.view.artist starts before the run.

OpenGL without a display must be chosen before MuJoCo is imported, and no run is to wait for pictures.
"""

import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from functools import partial
from itertools import accumulate
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from harness.base.errors import HarnessError
from harness.base.files import whole_file
from harness.episode.assembly import scenery
from harness.physics.drawn_ground import NEAR, DrawnGround
from harness.physics.ruts import PressedRuts
from harness.physics.stage import FIELD_OF_VIEW, Quality, aim_sun, dress, visible_groups
from harness.robots.lidar import LidarSpec, directions
from harness.sensors.lidar import Lidar
from harness.view.camera import View, best_view, chase_view, scale_of
from harness.view.caption import captioned
from harness.view.ground import drawn
from harness.view.marks import Mark, add_marks, beam_marks, path_marks, track_marks
from harness.view.posing import Posing
from harness.view.states import States, read_states

SCALE = 2  # a picture of 1280 x 640 is drawn twice as large: edges and shadows get smooth
QUALITY = Quality(width=SCALE * 1280, height=SCALE * 640, samples=0, shadow_map=4096, slices=28)
KEPT_BITS = 0xFC  # of each colour: the last two are noise that doubles the file
VIDEO_QUALITY = Quality(width=960, height=480, samples=2, shadow_map=2048, slices=16)
FRAME_RATE = 25  # [Hz], the recording's
MOST_FRAMES = 250  # 10 s: a longer run is played faster, so that no video takes minutes to draw
MOST_GEOMS = 20_000  # of scene and marks together
CALMED = 2.0 * FRAME_RATE  # states that the camera takes to follow a turn


class Studio(AbstractContextManager["Studio"]):
    """Draws the states of one run with its marks; a context manager that gives OpenGL back.

    Args:
        paths: States of the run, a file per rover.
        quality: Of the images.
        lidar: Whether the beams are drawn.
        reach: From a rover to where ruts are drawn [m]; math.inf for everywhere.

    Attributes:
        recording: The states of the first rover, as many as of each further rover.
        data: The state that was posed last.
        half_width: Half the width of an image at unit distance.
        scale: Size of the first rover as a share of the usual one.
    """

    def __init__(
        self, paths: Sequence[Path], quality: Quality, *, lidar: bool, reach: float = NEAR
    ) -> None:
        recordings = [read_states(path) for path in paths]
        self.recording, run = recordings[0], recordings[0].run
        world, fleet = scenery(run)
        world = replace(world, ground=drawn(world.ground))
        dressed = partial(dress, quality=quality)
        self._ground = DrawnGround(world, reach)
        scenes = self._ground.scenes(fleet, run.timestep, dressed)
        self._rovers, self.model = list(zip(scenes, recordings, strict=True)), scenes[0].model
        self._posing = Posing(scenes)
        self.data = self._posing.data
        self._lidars = [
            Lidar(self.model, LidarSpec(beams=setup.lidar_beams), scene.own("lidar"), scene.others())
            for scene, setup in zip(scenes, run.rovers, strict=True)
            if lidar
        ]
        self.scale = scale_of(scenes[0].rover)
        self._marks, self._ruts, self._pressed = list[Mark](), PressedRuts(self._ground, scenes), 0
        for scene, states in self._rovers:
            self._marks += path_marks(states, world.ground)
            if not self._ground.leaves_ruts:
                self._marks += track_marks(states, world.ground, scene.rover)
        half_height = math.tan(math.radians(0.5 * FIELD_OF_VIEW))
        self.half_width = quality.width / quality.height * half_height
        self._renderer = mujoco.Renderer(self.model, quality.height, quality.width, max_geom=MOST_GEOMS)

    def __exit__(self, *_: object) -> None:
        self._renderer.close()

    def pose(self, index: int) -> None:
        """Takes the state of that index."""
        for number, (_, states) in enumerate(self._rovers):
            at = states.path[index], states.orientations[index], states.joints[index]
            self._posing.put(number, *at)
        self._posing.people(self.recording.people[index])
        self._posing.settle()

    def image(self, index: int, view: View) -> NDArray[np.uint8]:
        """Returns the state of that index, shape (height, width, 3)."""
        self._press_until(index)
        self.pose(index)
        aim_sun(self.model, self.recording.path[index], view.azimuth)
        mujoco.mj_camlight(self.model, self.data)
        self._renderer.update_scene(self.data, view.camera(), visible_groups())
        scene = self._renderer.scene
        add_marks(scene, [*self._marks, *self._beams()], self.recording.times[index])
        scene.flags[mujoco.mjtRndFlag.mjRND_HAZE] = True
        return np.asarray(self._renderer.render())

    def _press_until(self, index: int) -> None:
        """Leaves the ruts of all states up to one."""
        if not self._ground.leaves_ruts:
            return
        end = range(len(self.recording.times))[index] + 1
        run, times = self.recording.run, self.recording.times.tolist()
        resets = () if run.world.keep_ruts else run.plan.resets
        for state in range(self._pressed, end):
            if any(times[max(state - 1, 0)] <= reset < times[state] for reset in resets):
                self._ground.smooth()
            self.pose(state)
            self._ruts.press(self.data)
        self._pressed = end
        self._renderer._gl_context.make_current()  # noqa: SLF001 - MuJoCo offers no other way
        context = self._renderer._mjr_context  # noqa: SLF001
        upload = partial(mujoco.mjr_uploadHField, self.model, context)
        x, y, *_ = self.recording.path[index].tolist()
        self._ground.show(x, y, upload)

    def best_view(self, yaw: float) -> View:
        """Returns the best view of the first rover, with a heading [rad], at the end of its path."""
        places = [states.path[-1] for _, states in self._rovers[1:]]
        others, path = np.array(places) if places else None, self.recording.path
        return best_view(self.model, self.data, path, yaw, self.half_width, others, self.scale)

    def _beams(self) -> list[Mark]:
        marks = []
        for lidar, (scene, _) in zip(self._lidars, self._rovers, strict=False):
            site = self.data.site(scene.own("lidar"))
            beams = directions(lidar.spec.angles) @ site.xmat.reshape(3, 3).T
            marks += beam_marks(site.xpos, beams, lidar.scan(self.data))
        return marks


def _tell(done: int, total: int) -> None:
    """Prints for harness.view.drawing how many frames are drawn, and of how many."""
    print(f"{done}/{total}", flush=True)


def _draw_picture(recordings: Sequence[Path], target: Path, camera: str, *, lidar: bool) -> None:
    """Draws the end of a recording with the path that led there, as PNG."""
    _tell(0, 1)
    with Studio(recordings, QUALITY, lidar=lidar, reach=math.inf) as studio:
        states = studio.recording
        studio.pose(-1)
        yaw, scale, place = states.yaw[-1], studio.scale, states.path[-1]
        view = chase_view(place, yaw, scale, camera) if camera else studio.best_view(yaw)
        image = Image.fromarray(studio.image(-1, view)).reduce(SCALE)
    with whole_file(target) as part:
        image.point(lambda value: value & KEPT_BITS).save(part, format="PNG")
    _tell(1, 1)


def _draw_video(recordings: Sequence[Path], target: Path, camera: str, *, lidar: bool) -> None:
    """Draws a recording as H.264 in MP4: the camera follows the rover, the path grows behind it."""
    import av  # noqa: PLC0415 - its extra may be missing

    with Studio(recordings, VIDEO_QUALITY, lidar=lidar) as studio, whole_file(target) as part:
        count = len(studio.recording.times)
        frames = range(0, count, -(-count // MOST_FRAMES))
        views = chase(studio.recording, studio.scale, camera or "chase")
        times, speeds = studio.recording.times, studio.recording.speed
        with av.open(str(part), "w", format="mp4") as container:
            stream = container.add_stream("libx264", rate=FRAME_RATE, options={"crf": "23"})
            stream.width, stream.height = VIDEO_QUALITY.width, VIDEO_QUALITY.height
            stream.pix_fmt = "yuv420p"
            for done, index in enumerate(frames):
                _tell(done, len(frames))
                drawn = studio.image(index, views[index])
                drawn = captioned(drawn, times[index], speeds[index], frames.step)
                container.mux(stream.encode(av.VideoFrame.from_ndarray(drawn, format="rgb24")))
            container.mux(stream.encode())
        _tell(len(frames), len(frames))


def chase(recording: States, scale: float = 1.0, camera: str = "chase") -> list[View]:
    """Returns a view at each state that follows the rover, and turns more calmly than it.

    Args:
        recording: States of the drive.
        scale: Of distances, by the rover's size.
        camera: As `chase_view` takes it.
    """
    headings = accumulate(recording.yaw.tolist(), lambda calm, yaw: calm + (yaw - calm) / CALMED)
    places = zip(recording.path, headings, strict=True)
    return [chase_view(place, yaw, scale, camera) for place, yaw in places]


DRAWN: Mapping[str, Callable[..., None]] = {"--picture": _draw_picture, "--video": _draw_video}


def draw(recordings: Sequence[str], files: Mapping[str, str], camera: str, *, lidar: bool) -> None:
    """Draws the states of a run.

    Args:
        recordings: A file per rover, as harness.view.states has them.
        files: What to draw, by the option that asks for it.
        camera: As `chase_view` takes it; "" for where much is seen, or from behind.
        lidar: Whether the beams that hit something are shown.
    """
    for option, target in files.items():
        DRAWN[option](list(map(Path, recordings)), Path(target), camera, lidar=lidar)


def main() -> int:
    """Tries out OpenGL, then draws what a line of JSON asks for, if any; returns the exit code."""
    try:
        # The error that MuJoCo raises without OpenGL is what the parent process looks for.
        mujoco.Renderer(mujoco.MjModel.from_xml_string("<mujoco/>"), 16, 16).close()
        print("ready", flush=True)
        if order := sys.stdin.readline():
            draw(**json.loads(order))
    except (HarnessError, OSError) as error:
        print(f"harness.view.picture: {error}", file=sys.stderr)
        return error.exit_code if isinstance(error, HarnessError) else 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
