"""The world of a run in a viser scene, its rovers and people where they are now."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from threading import Lock

import mujoco
import numpy as np
import viser
from numpy.typing import NDArray

from harness.episode.assembly import scenery
from harness.physics.scene import build_scenes
from harness.physics.stage import FIELD_OF_VIEW, HAZE, SUN_ELEVATION, Quality, dress
from harness.robots.lidar import LidarSpec, directions
from harness.samples import Place
from harness.spec.run import Run
from harness.view.camera import SOLID_GROUPS, chase_view, scale_of
from harness.view.ground import drawn
from harness.view.live.shapes import WORLD, gltf_of_bodies
from harness.view.live.watch import Watch
from harness.view.marks import HIT_COLOR, PATH_COLOR
from harness.view.posing import Posing

QUALITY = Quality(width=64, height=64, samples=0, shadow_map=64, slices=16)  # nothing is drawn here
ROOT = "/world"
PATH_WIDTH, PATH_RAISED, HIT_SIZE = 0.04, 0.03, 0.05  # [m]
SUN, SKYLIGHT = 1.8, 0.7  # how bright
FARTHEST = 45.0, 110.0  # [m] where haze begins, and where it hides everything
FURTHER = 2.5  # times as far as a video's camera, so that one sees where it goes
GOAL_SIZE = 0.03, 0.8  # [m] radius and height of the post that marks a goal

Points = NDArray[np.float64]


def rgb(color: Sequence[float]) -> tuple[int, int, int]:
    """Returns a colour from 0 to 1 as viser has it."""
    red, green, blue = (round(255 * part) for part in color[:3])
    return red, green, blue


class Stage:
    """The scene of a page: everything stands below one frame, which moves so that the rover stays put.

    A browser's camera thus follows by itself, and may be turned freely.

    Args:
        scene: Of the page's server.
        run: What is shown.

    Attributes:
        following: The place in the run of the rover that stays put; None leaves the world where it is.
        hits: Where the lidar of each rover hits something, as points in the world [m].
    """

    def __init__(self, scene: viser.SceneApi, run: Run) -> None:
        world, fleet = scenery(run)
        world = replace(world, ground=drawn(world.ground), soil=None)  # without ruts
        self._scenes = build_scenes(world, fleet, run.timestep, partial(dress, quality=QUALITY))
        self._model, self._scene = self._scenes[0].model, scene
        self._posing, self._lock = Posing(self._scenes), Lock()
        self._posing.settle()
        self._beams = [LidarSpec(beams=rover.lidar_beams).angles for rover in run.rovers]
        self.following: int | None = 0
        self._light(scene)
        self._root = scene.add_frame(ROOT, show_axes=False)
        data = self._posing.data
        self._bodies = {
            body: scene.add_glb(
                f"{ROOT}/{self._model.body(body).name or body}".replace("//", "/"),
                glb,
                position=data.xpos[body],
                wxyz=data.xquat[body],
            )
            for body, glb in gltf_of_bodies(self._model, data).items()
        }
        numbers = range(len(run.rovers))
        self._paths = [self._add_path(number) for number in numbers]
        self.hits = [self._add_hits(number) for number in numbers]
        for target in world.targets:
            x, y, z = target.position
            scene.add_label(f"{ROOT}/targets/{target.name}", target.name, position=(x, y, z + 0.4))

    def aim(self, camera: viser.InitialCameraConfig) -> None:
        """Puts a browser's camera behind the first rover."""
        camera.position, camera.look_at = self._view()
        camera.fov = math.radians(FIELD_OF_VIEW)

    def _view(self) -> tuple[Points, Points]:
        """Where a camera is that looks at the first rover, and at what; both from the rover [m]."""
        start = self._scenes[0].world.start
        view = chase_view(np.zeros(3), start[2], scale_of(self._scenes[0].rover))
        return view.target - FURTHER * view.distance * view.direction, view.target

    def show_lidar(self, shown: bool) -> None:
        """Shows where lidars hit something, or not."""
        for hits in self.hits:
            hits.visible = shown

    def draw(self, watches: Sequence[Watch]) -> None:
        """Shows what was seen of each rover last."""
        with self._lock:
            for number, watch in enumerate(watches):
                if watch.sight is not None:
                    self._posing.put(number, *watch.sight)
            self._posing.people(watches[0].people)
            self._posing.settle()
            data = self._posing.data
            for body, handle in self._bodies.items():
                if body != WORLD:
                    handle.position, handle.wxyz = data.xpos[body], data.xquat[body]
            if self.following is not None:
                self._root.position = -data.xpos[self._scenes[self.following].root]
            for number, watch in enumerate(watches):
                self._draw_hits(number, watch)

    def draw_paths(self, watches: Sequence[Watch]) -> None:
        """Shows where each rover has been."""
        for watch, path in zip(watches, self._paths, strict=True):
            points = np.array(watch.path.copy()).reshape(-1, 3)
            points[:, 2] += PATH_RAISED
            if len(points) > 1:
                path.points = np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)

    def mark(self, goal: Place) -> None:
        """Shows a goal."""
        height = self._scenes[0].world.ground.height_at(goal.x, goal.y)
        radius, length = GOAL_SIZE
        self._scene.add_cylinder(
            f"{ROOT}/goal",
            radius,
            length,
            color=rgb(PATH_COLOR),
            position=(goal.x, goal.y, height + 0.5 * length),
        )

    def under(self, origin: Sequence[float], direction: Sequence[float]) -> Points | None:
        """Returns what of ground and obstacles a ray meets, in the world [m]; None for nothing.

        Args:
            origin: Where it begins, in the page's scene [m].
            direction: Unit vector.
        """
        begin, along = np.array(origin) - self._root.position, np.array(direction)
        hit = np.zeros(1, np.int32)
        with self._lock:
            data = self._posing.data
            far = mujoco.mj_ray(self._model, data, begin, along, SOLID_GROUPS, 1, -1, hit, None)
        return None if far < 0.0 else begin + far * along

    def _draw_hits(self, number: int, watch: Watch) -> None:
        ranges, angles = watch.ranges, self._beams[number]
        if ranges is None or not self.hits[number].visible:
            return
        site = self._posing.data.site(self._scenes[number].own("lidar"))
        count = min(len(ranges), len(angles))  # a fault in a recording may have cut or stretched it
        ranges, angles = ranges[:count], angles[:count]
        near = np.isfinite(ranges)
        points = site.xpos + ranges[near, None] * (directions(angles[near]) @ site.xmat.reshape(3, 3).T)
        self.hits[number].points = points.astype(np.float32)

    def _add_path(self, number: int) -> viser.LineSegmentsHandle:
        return self._scene.add_line_segments(
            f"{ROOT}/paths/{number}", np.zeros((0, 2, 3)), rgb(PATH_COLOR), thickness=PATH_WIDTH
        )

    def _add_hits(self, number: int) -> viser.PointCloudHandle:
        return self._scene.add_point_cloud(
            f"{ROOT}/lidar/{number}",
            np.zeros((0, 3)),
            rgb(HIT_COLOR),
            point_size=HIT_SIZE,
            point_shape="circle",
            precision="float32",
        )

    @staticmethod
    def _light(scene: viser.SceneApi) -> None:
        """A low sun with shadows, sky, and haze in its colour."""
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map(environment_intensity=SKYLIGHT)
        level, up = math.cos(SUN_ELEVATION), math.sin(SUN_ELEVATION)
        scene.add_light_directional(
            "/light/sun",
            intensity=SUN,
            cast_shadow=True,
            position=(-7.0 * level, -7.0 * level, 10.0 * up),
        )
        scene.set_background_image(np.full((8, 8, 3), HAZE, np.uint8), "png")
        scene.configure_fog(*FARTHEST, color=HAZE)
