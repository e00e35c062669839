"""Rovers that come to rest on the ground before their time begins, so that no drop is measured."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import mujoco

from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.physics.health import check_health
from harness.physics.rover import Rover
from harness.physics.start import spawn_pose
from harness.world.world import Start

if TYPE_CHECKING:
    from harness.physics.physics import Physics

LIMIT_NS = 5 * NANOSECONDS
FREE_NS = 1 * NANOSECONDS  # of that the wheels may roll; held ones would keep rockers from following


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
