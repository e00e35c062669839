"""Rovers that come to rest on the ground before their time begins, so that no drop is measured."""

from collections.abc import Sequence

import mujoco

from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.physics.health import check_health
from harness.physics.rover import Rover
from harness.physics.start import spawn_pose
from harness.world.world import Start

LIMIT_NS = 5 * NANOSECONDS
FREE_NS = 1 * NANOSECONDS  # of that the wheels may roll; held ones would keep rockers from following


def settle(
    data: mujoco.MjData,
    rovers: Sequence[Rover],
    starts: Sequence[tuple[Rover, Start]],
    timestep_ns: int,
    time_ns: int,
) -> None:
    """Lets rovers down onto the ground, which takes no time.

    Each of them comes to rest as if it were alone: who rests waits for the slower ones as it is, and so
    do all others.

    Args:
        data: The state of their world.
        rovers: All of that world.
        starts: Where those that are let down are put.
        timestep_ns: Of the world's model.
        time_ns: Simulation time, for an error.

    Raises:
        Diverged: One of them cannot stand there.
    """
    falling = [rover for rover, _ in starts]
    waiting = [(rover, rover.state()) for rover in rovers if rover not in falling]
    for rover, start in starts:
        rover.pose[:] = spawn_pose(rover.scene, start)
    for tick in range(LIMIT_NS // TICK_NS):
        for rover, _ in starts:
            rover.parking.hold(tick >= FREE_NS // TICK_NS)
        mujoco.mj_step(data.model, data, TICK_NS // timestep_ns)
        check_health(data, rovers, time_ns)
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
