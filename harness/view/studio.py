"""Draws the states of a recorded episode, with its marks, from any view.

Importing it needs no OpenGL; making a `Studio` does.
"""

import math
from functools import partial
from pathlib import Path
from typing import Self

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.scene import build_scene
from harness.robots import find_rover
from harness.sensors.lidar import Lidar
from harness.sensors.lidar_spec import LidarSpec
from harness.view.camera import View
from harness.view.marks import Mark, add_marks, beam_marks, path_marks, track_marks
from harness.view.stage import FIELD_OF_VIEW, Quality, aim_sun, dress, visible_groups
from harness.view.states import read_states

MOST_GEOMS = 20_000  # of scene and marks together


class Studio:
    """Draws the states of one recording; a context manager that gives the OpenGL context back.

    Attributes:
        recording: The states.
        model: The scene that they are states of.
        data: The state that was posed last.
        half_width: Half the width of an image at unit distance.
    """

    def __init__(self, path: Path, quality: Quality, *, lidar: bool) -> None:
        self.recording = read_states(path)
        config = self.recording.config
        rover, world = find_rover(config.robot), config.world()
        self.model = build_scene(world, rover, config.timestep, partial(dress, quality=quality)).model
        self.data = mujoco.MjData(self.model)
        self._joints = [int(self.model.joint(name).qposadr[0]) for name in rover.joints]
        self._lidar = Lidar(self.model, LidarSpec(beams=config.lidar_beams)) if lidar else None
        self._marks = [
            *path_marks(self.recording, world.ground),
            *track_marks(self.recording, world.ground, rover),
        ]
        half_height = math.tan(math.radians(0.5 * FIELD_OF_VIEW))
        self.half_width = quality.width / quality.height * half_height
        self._renderer = mujoco.Renderer(self.model, quality.height, quality.width, max_geom=MOST_GEOMS)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._renderer.close()

    def pose(self, index: int) -> None:
        """Takes the state of that index."""
        states = self.recording
        self.data.qpos[:7] = (*states.path[index], *states.orientations[index])
        self.data.qpos[self._joints] = states.joints[index]
        mujoco.mj_forward(self.model, self.data)

    def image(self, index: int, view: View) -> NDArray[np.uint8]:
        """The state of that index, shape (height, width, 3)."""
        self.pose(index)
        aim_sun(self.model, self.recording.path[index], view.azimuth)
        mujoco.mj_camlight(self.model, self.data)
        self._renderer.update_scene(self.data, view.camera(), visible_groups())
        scene = self._renderer.scene
        add_marks(scene, [*self._marks, *self._beams()], self.recording.times[index])
        scene.flags[mujoco.mjtRndFlag.mjRND_HAZE] = True
        return np.asarray(self._renderer.render())

    def _beams(self) -> list[Mark]:
        if self._lidar is None:
            return []
        site = self.data.site("lidar")
        angles = self._lidar.spec.angles
        level = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
        directions = level @ site.xmat.reshape(3, 3).T
        return beam_marks(site.xpos, directions, self._lidar.scan(self.data))
