"""Where a rover is set down, how it comes to rest there, and whether it can be there."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.physics.health import check_health
from harness.physics.rover import Rover
from harness.physics.scene import Scene
from harness.physics.world_geoms import OBSTACLE_GROUP
from harness.world.world import Start

if TYPE_CHECKING:
    from harness.physics.physics import Physics

DROP_HEIGHT = 0.01  # [m] over the highest ground below the footprint
LIMIT_NS = 5 * NANOSECONDS  # to come to rest
FREE_NS = 1 * NANOSECONDS  # of that the wheels may roll; held ones would keep rockers from following
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


def settle(physics: "Physics", starts: Sequence[tuple[Rover, Start]]) -> None:
    """Lets rovers of a world down onto the ground, so that no drop is measured; no time passes.

    Each of them comes to rest as if it were alone: who rests waits for the slower ones as it is, and so
    do all others.

    Args:
        physics: Of all rovers of the world.
        starts: Where those that are let down are put.

    Raises:
        Diverged: One of them cannot stand there.
    """
    data, falling = physics.data, [rover for rover, _ in starts]
    waiting = [(rover, rover.state()) for rover in physics.rovers if rover not in falling]
    for rover, start in starts:
        rover.pose[:] = spawn_pose(rover.scene, start)
    for tick in range(LIMIT_NS // TICK_NS):
        for rover, _ in starts:
            rover.parking.hold(tick >= FREE_NS // TICK_NS)
        mujoco.mj_step(physics.model, data, physics.steps_per_tick)
        check_health(data, physics.rovers, physics.time_ns)
        for rover, state in waiting:
            rover.restore(state)
        for rover in [rover for rover in falling if rover.rests(data)]:
            falling.remove(rover)
            waiting.append((rover, rover.state()))
        if not falling:
            break
    for rover, _ in starts:
        rover.parking.hold(True)
    data.time = 0.0


def check_room(scene: Scene, fleet: Sequence[Scene] = ()) -> None:
    """Checks a start that somebody chose, before a rover is set down there.

    Args:
        scene: The rover in its world.
        fleet: All rovers of that world, at their starts; none but this one if left out.

    Raises:
        UsageError: An obstacle or another rover is in the way.
    """
    if names := _in_the_way(scene, fleet or (scene,)):
        start, mend = _named(scene)
        raise UsageError(f"{start} is inside {', '.join(names)}; choose another {mend}")


def check_start(scene: Scene, settled: mujoco.MjData) -> None:
    """Checks where a rover has come to rest that was set down at a chosen start.

    Args:
        scene: The rover in its world.
        settled: The state that it came to from there.

    Raises:
        UsageError: The ground is too steep to stand on.
    """
    pose = settled.qpos[scene.qpos_at : scene.qpos_at + 7]
    slid = math.dist(pose[:2], scene.world.start[:2])
    w, x, y, z = pose[3:].tolist()
    tilt = math.acos(min(1.0, w * w - x * x - y * y + z * z))
    if slid > MOST_SLID or tilt > MOST_TILTED:
        start, mend = _named(scene)
        raise UsageError(
            f"no rover can stand at {start}: it slid {slid:.1f} m and leans by "
            f"{math.degrees(tilt):.0f} deg; choose another {mend}, on gentler ground"
        )


def _named(scene: Scene) -> tuple[str, str]:
    """What a start is called, and what to choose another of."""
    start, name = "start " + ",".join(f"{value:g}" for value in scene.world.start), scene.name
    return (f"{start} of {name}", f"x and y for {name}") if name else (start, "--start")


def _in_the_way(scene: Scene, fleet: Sequence[Scene]) -> list[str]:
    """Names of the obstacles and of the rovers in which the rover would be set down."""
    model, data = scene.model, mujoco.MjData(scene.model)
    for each in fleet:
        data.qpos[each.qpos_at : each.qpos_at + 7] = spawn_pose(each, each.world.start)
    mujoco.mj_fwdPosition(model, data)
    own, pairs = scene.geoms(), data.contact.geom
    touched = set(np.unique(pairs[np.isin(pairs, own).any(axis=1)]).tolist()) - set(own)
    obstacles = [geom for geom in sorted(touched) if model.geom_group[geom] == OBSTACLE_GROUP]
    others = [each.label for each in fleet if each is not scene and touched.intersection(each.geoms())]
    return [*(model.geom(geom).name for geom in obstacles), *others]
