from collections.abc import Callable, Iterator
from functools import partial

import mujoco
import numpy as np
import pytest

from harness.base.errors import Diverged, RunFailed
from harness.base.sim_time import TICK_NS
from harness.physics.simulation import Simulation
from harness.robots import ROVERS
from harness.world.obstacles import Obstacle, ObstacleKind
from tests.harness.conftest import MakeSimulation

WHOLE = int(mujoco.mjtState.mjSTATE_INTEGRATION)
POST = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 0.4, 0.5), (0.42, 0.0, 0.5))
# [rad/s] of left and right wheels, tick by tick: it stands, sets off, turns, is parked within a leap.
SPEEDS = np.array(
    [(0, 0)] * 5 + [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)] + [(6, 6)] * 50 + [(4, -4)] * 8
)
SPEEDS = np.vstack([SPEEDS, [(0, 0)] * 7])[:, [0, 0, 1, 1]].astype(float)


def state(simulation: Simulation) -> list[float]:
    whole = np.empty(mujoco.mj_stateSize(simulation.model, WHOLE))
    mujoco.mj_getState(simulation.model, simulation.data, whole, WHOLE)
    return list(whole.tolist())


def push_of_post(simulation: Simulation) -> float:
    """The largest normal force of the post in the present step [N], of all of MuJoCo's contacts."""
    post, force, largest = simulation.model.geom("hazard_0").id, np.zeros(6), 0.0
    for index, pair in enumerate(simulation.data.contact.geom.tolist()):
        mujoco.mj_contactForce(simulation.model, simulation.data, index, force)
        largest = max(largest, float(force[0])) if post in pair else largest
    return largest


@pytest.mark.parametrize("robot", ROVERS)
@pytest.mark.parametrize("watched", [True, False])
def test_ticks_in_one_go_give_the_bits_and_the_contacts_of_single_steps(
    make_simulation: MakeSimulation, robot: str, watched: bool
) -> None:
    heights = np.random.default_rng(1).normal(0.0, 0.01, (41, 41))
    stepped, going = (make_simulation(robot, heights=heights, obstacles=(POST,)) for _ in range(2))
    model, data, touched = stepped.model, stepped.data, 0
    for number, period in enumerate(SPEEDS.reshape(-1, 5, 4)):
        going.command_ahead(period)
        going.physics.run(watched=watched)
        for tick in going.physics.shown():
            stepped.command_wheels(period[tick])
            total, strongest = np.zeros(model.nsensordata), 0.0
            for _ in range(stepped.steps_per_tick):
                mujoco.mj_step(model, data)
                total += data.sensordata
                strongest = max(strongest, push_of_post(stepped))
            assert going.time_ns == (5 * number + tick + 1) * TICK_NS
            assert going.tick_sum.tolist() == total.tolist()
            for name in ("qpos", "qvel", "qfrc_actuator"):
                assert getattr(going.data, name).tolist() == getattr(data, name).tolist()
            if watched:
                hazard = going.contacts.strongest.get("hazard")
                assert (0.0 if hazard is None else hazard.force) == strongest
            touched += bool(strongest)
        assert state(going) == state(stepped)
    assert touched  # or the test would say nothing about contacts


@pytest.mark.parametrize("late", [0, 3])
def test_what_goes_wrong_within_a_span_is_told_of_its_tick_after_those_before(
    make_simulation: MakeSimulation, late: int
) -> None:
    leaving, twin = (make_simulation() for _ in range(2))
    for simulation in (leaving, twin):  # half a metre before the map's edge at 2 m
        simulation.data.qpos[0], simulation.data.qvel[0] = 1.497 - 0.004 * late, 1.0
    ticks = ticks_of(leaving, np.zeros((5, 4)))
    while (failure := failure_of(twin.tick)) is None:
        next(ticks)
    assert (leaving.time_ns > 0) == (late > 0)
    assert failure_of(partial(next, ticks)) == failure
    assert leaving.position == twin.position
    broken = make_simulation()
    ticks = ticks_of(broken, np.repeat([[0.0] * 4, [np.nan] * 4], [late, 5 - late], axis=0))
    assert [next(ticks) for _ in range(late)] == list(range(late))
    with pytest.raises(Diverged, match=rf"t = 0\.0{late + 1} s"):
        next(ticks)


def ticks_of(simulation: Simulation, commands: np.ndarray) -> Iterator[int]:
    simulation.command_ahead(commands)
    simulation.physics.run()
    return simulation.physics.shown()


def failure_of(work: Callable[[], object]) -> str | None:
    try:
        work()
    except RunFailed as error:
        return str(error)
    return None
