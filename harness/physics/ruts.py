"""Ruts in a model that is only drawn, as harness.soil.bed leaves them: its wheels press as they pass."""

from collections.abc import Sequence

import mujoco
import numpy as np

from harness.physics.scene import TERRAIN, Scene, soil_ground

BESIDE = (1.0, 3.0)  # [cells] from a wheel's side: where what it displaced is heaped


class DrawnRuts:
    """The ground of a scene on soil, without ruts at first.

    Args:
        scenes: Of all rovers in one model.
    """

    def __init__(self, scenes: Sequence[Scene]) -> None:
        model, ground = scenes[0].model, soil_ground(scenes[0].world)
        geom = model.geom(TERRAIN).id
        self.field = int(model.geom_dataid[geom])
        start, (rows, columns) = int(model.hfield_adr[self.field]), ground.heights.shape
        self._shown = model.hfield_data[start:][: rows * columns].reshape(rows, columns)
        self._base, self._relief = (
            float(model.geom_pos[geom, 2]),
            float(model.hfield_size[self.field, 2]),
        )
        self._heights, self._cell = ground.heights.copy(), ground.cell
        (half_x, half_y), (x, y) = ground.half_size, ground.middle
        self._corner = np.array([x - half_x, y - half_y])
        self._shown[:] = (self._heights - self._base) / self._relief
        joints = [(scene, name) for scene in scenes for name in scene.all_own(scene.rover.wheel_joints)]
        self._wheels = [
            (model.joint(name).id, int(model.joint(name).bodyid[0]), scene.rover)
            for scene, name in joints
        ]

    def press(self, data: mujoco.MjData) -> None:
        """Lets all wheels press the ground where they are."""
        for joint, body, rover in self._wheels:
            x, y, _ = data.xaxis[joint]
            ahead = np.array([y, -x]) / max(float(np.hypot(x, y)), 1e-9)
            self._print(data.xpos[body], ahead, rover.wheel_radius, 0.5 * rover.wheel_width)

    def show(self, patch: tuple[int, int, np.ndarray]) -> None:
        """Shows these heights, from 0 to 1 from a row and a column on, and no ruts elsewhere."""
        row, column, values = patch
        self._shown[:] = (self._heights - self._base) / self._relief
        self._shown[row : row + values.shape[0], column : column + values.shape[1]] = values

    def _print(self, hub: np.ndarray, ahead: np.ndarray, radius: float, half_width: float) -> None:
        reach = radius + half_width + BESIDE[1] * self._cell
        first = np.maximum(((hub[:2] - reach - self._corner) / self._cell).astype(int), 0)
        last = ((hub[:2] + reach - self._corner) / self._cell).astype(int) + 2
        window = slice(first[1], last[1]), slice(first[0], last[0])
        heights = self._heights[window]
        rows, columns = np.indices(heights.shape)
        dx = self._corner[0] + (first[0] + columns) * self._cell - hub[0]
        dy = self._corner[1] + (first[1] + rows) * self._cell - hub[1]
        along, across = dx * ahead[0] + dy * ahead[1], np.abs(dy * ahead[0] - dx * ahead[1])
        bottom = hub[2] - np.sqrt(np.maximum(radius**2 - along**2, 0.0))
        under = (np.abs(along) < radius) & (across <= half_width)
        lowered = np.where(under, np.maximum(heights - bottom, 0.0), 0.0)
        near, far = (half_width + cells * self._cell for cells in BESIDE)
        beside = (lowered.max(axis=0).any() & (across >= near) & (across <= far)) & (
            np.abs(along) < 0.5 * radius
        )
        heights -= lowered
        heights[beside] += lowered.sum() / max(int(beside.sum()), 1)
        self._shown[window] = (heights - self._base) / self._relief


def drawn_ruts(scenes: Sequence[Scene]) -> DrawnRuts | None:
    """Returns the ruts of a scene that is drawn; None where none are left."""
    soil = scenes[0].world.soil
    return DrawnRuts(scenes) if soil is not None and any(s.leaves_ruts for s in soil.kinds) else None
