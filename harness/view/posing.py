"""Rovers and people of a scene, put where samples say that they are."""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.physics.scene import Scene


class Posing:
    """Poses the rovers of a scene and its people.

    Args:
        scenes: Each rover in the model that all share.

    Attributes:
        data: The state that is posed.
    """

    def __init__(self, scenes: Sequence[Scene]) -> None:
        self._model = scenes[0].model
        self.data = mujoco.MjData(self._model)
        self._places = [
            (scene.qpos_at, [int(self._model.joint(name).qposadr[0]) for name in joints])
            for scene in scenes
            for joints in [scene.all_own(scene.rover.joints)]
        ]

    def put(self, number: int, position: ArrayLike, wxyz: ArrayLike, joints: ArrayLike) -> None:
        """Puts a rover somewhere.

        Args:
            number: Its place among the scenes.
            position: Of its model frame [m].
            wxyz: Its attitude as (w, x, y, z).
            joints: Positions of its joints, in their order.
        """
        at, own = self._places[number]
        self.data.qpos[at : at + 3], self.data.qpos[at + 3 : at + 7] = position, wxyz
        self.data.qpos[own] = joints

    def people(self, places: NDArray[np.float64]) -> None:
        """Puts people, the only mocap bodies: x, y, z [m] and heading [rad], shape (people, 4)."""
        if places.size:
            self.data.mocap_pos[:] = places[:, :3]
            half = places[:, 3] / 2
            self.data.mocap_quat[:, 0], self.data.mocap_quat[:, 3] = np.cos(half), np.sin(half)

    def settle(self) -> None:
        """Computes where all parts are then."""
        mujoco.mj_forward(self._model, self.data)
