"""Ruts of a recorded run, as harness.soil.bed leaves them: its wheels press the ground as they pass."""

from collections.abc import Sequence

import mujoco
import numpy as np

from harness.physics.drawn_ground import DrawnGround
from harness.physics.scene import Scene

BESIDE = (1.0, 3.0)  # [cells] from a wheel's side: where what it displaced is heaped


class PressedRuts:
    """Presses the ground of a scene that is only drawn.

    Args:
        ground: Without ruts at first.
        scenes: Of all rovers in one model.
    """

    def __init__(self, ground: DrawnGround, scenes: Sequence[Scene]) -> None:
        self._ground, model = ground, scenes[0].model
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

    def _print(self, hub: np.ndarray, ahead: np.ndarray, radius: float, half_width: float) -> None:
        corner, cell = self._ground.corner, self._ground.cell
        reach = radius + half_width + BESIDE[1] * cell
        first = np.maximum(((hub[:2] - reach - corner) / cell).astype(int), 0)
        last = ((hub[:2] + reach - corner) / cell).astype(int) + 2
        heights = self._ground.heights[first[1] : last[1], first[0] : last[0]]  # a view
        rows, columns = np.indices(heights.shape)
        dx = corner[0] + (first[0] + columns) * cell - hub[0]
        dy = corner[1] + (first[1] + rows) * cell - hub[1]
        along, across = dx * ahead[0] + dy * ahead[1], np.abs(dy * ahead[0] - dx * ahead[1])
        bottom = hub[2] - np.sqrt(np.maximum(radius**2 - along**2, 0.0))
        under = (np.abs(along) < radius) & (across <= half_width)
        lowered = np.where(under, np.maximum(heights - bottom, 0.0), 0.0)
        near, far = (half_width + cells * cell for cells in BESIDE)
        beside = (lowered.max(axis=0).any() & (across >= near) & (across <= far)) & (
            np.abs(along) < 0.5 * radius
        )
        heights -= lowered
        heights[beside] += lowered.sum() / max(int(beside.sum()), 1)
