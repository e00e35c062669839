"""Where a rover is set down, and whether it can be there."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError
from harness.physics.scene import OBSTACLE_GROUP, Scene
from harness.world.world import Start

DROP_HEIGHT = 0.01  # [m] over the highest ground below the footprint
MOST_SLID = 0.5  # [m] from where it was set down to where it came to rest
MOST_TILTED = math.radians(60.0)  # at rest: beyond it, it lies on its side


def spawn_pose(scene: Scene, start: Start) -> NDArray[np.float64]:
    """Returns position [m] and w, x, y, z of an upright rover just over the ground at a start."""
    x, y, yaw = start
    x_min, x_max, y_min, y_max = scene.rover.footprint
    ground, cos, sin = scene.world.ground, math.cos(yaw), math.sin(yaw)
    ahead, left = np.meshgrid(
        *(np.arange(*ends, ground.cell / 2) for ends in ((x_min, x_max), (y_min, y_max)))
    )
    highest = ground.heights_at(x + cos * ahead - sin * left, y + sin * ahead + cos * left).max()
    height = highest + scene.rover.rest_height + DROP_HEIGHT
    return np.array([x, y, height, math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)])


def check_room(scene: Scene) -> None:
    """Checks a start that somebody chose, before a rover is set down there.

    Raises:
        UsageError: An obstacle is in the way.
    """
    if names := _in_the_way(scene):
        raise UsageError(f"{_told(scene)} is inside {', '.join(names)}; choose another --start")


def check_start(scene: Scene, settled: mujoco.MjData) -> None:
    """Checks what came of a start that somebody chose.

    Args:
        scene: The rover in its world.
        settled: The state that it came to from there.

    Raises:
        UsageError: The ground is too steep to stand on.
    """
    slid = math.dist(settled.qpos[:2], scene.world.start[:2])
    w, x, y, z = settled.qpos[3:7].tolist()
    tilt = math.acos(min(1.0, w * w - x * x - y * y + z * z))
    if slid > MOST_SLID or tilt > MOST_TILTED:
        raise UsageError(
            f"no rover can stand at {_told(scene)}: it slid {slid:.1f} m and leans by "
            f"{math.degrees(tilt):.0f} deg; choose another --start, on gentler ground"
        )


def _told(scene: Scene) -> str:
    return "start " + ",".join(f"{value:g}" for value in scene.world.start)


def _in_the_way(scene: Scene) -> list[str]:
    """Names of the obstacles in which the rover would be set down."""
    model, data = scene.model, mujoco.MjData(scene.model)
    data.qpos[:7] = spawn_pose(scene, scene.world.start)
    mujoco.mj_fwdPosition(model, data)
    touched = np.unique(data.contact.geom)
    return [model.geom(geom).name for geom in touched if model.geom_group[geom] == OBSTACLE_GROUP]
