import multiprocessing
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.base.errors import RunFailed, UsageError
from harness.base.sim_time import CONTROL_PERIOD_NS
from harness.episode import stream
from harness.episode.assembly import fleet
from harness.episode.batch import Batch
from harness.episode.stream import EpisodeProcess, RoverOrders
from harness.samples import Place, Pose, Twist
from harness.spec.fleet import parse_rovers
from harness.spec.rover import RoverSetup
from harness.spec.run import Run
from tests.support.forking import Forked


@pytest.fixture(autouse=True)
def _forked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Children are copies of this process, so that a change here is one there."""
    monkeypatch.setattr(stream, "multiprocessing", Forked())


def config(**changes: object) -> Run:
    values: dict[str, object] = {"terrain": "rocky", "duration": 2.0}
    return Run.of(**{**values, **changes})


def test_the_child_puts_the_rover_and_gives_it_goals_at_the_times_that_are_told() -> None:
    with EpisodeProcess(config(terrain="flat", driver="goal", duration=6.0, lidar_beams=2)) as process:
        process.begin()
        poses = []
        for index, (batch,) in enumerate(process.batches()):
            poses += [s for tick in batch.ticks for s in tick.samples if isinstance(s, Pose)]
            if index == 2:
                put = process.rovers[0].put(Place(5.0, 3.0, 1.0))
            if index == 20:
                again = process.rovers[0].put(Place(5.0, -3.0, 1.0))
                headed = process.rovers[0].head_for(Place(6.0, -3.0, 0.0))  # in the same period
        assert (
            process.rovers[0].put(Place(0.0, 0.0, 0.0))
            is process.rovers[0].head_for(Place(0.0, 0.0, 0.0))
            is None
        )
    assert put is not None
    assert headed is not None
    assert headed == again
    before = [pose.position[:2] for pose in poses if pose.stamp_ns <= put]
    there = [pose.position[:2] for pose in poses if put < pose.stamp_ns <= headed]
    assert np.abs(before).max() < 0.02
    assert np.abs(np.array(there) - (5.0, 3.0)).max() < 0.02
    assert poses[-1].position[:2] == pytest.approx((5.7, -3.0), abs=0.4)


def test_a_reset_forgets_a_command_of_the_same_period() -> None:
    rover = RoverSetup(driver="cmd_vel")
    orders = RoverOrders(SimpleNamespace(next_ns=5), rover)  # type: ignore[arg-type]  # of a process
    orders.command(Twist(0.5, 0.1))
    assert orders.reset() == 5
    told = orders.take()
    assert told is not None
    assert (told.reset, told.command) == (True, None)


def test_a_run_that_fails_says_so_although_orders_wait(tmp_path: Path) -> None:
    small = tmp_path / "small.npy"
    np.save(small, np.zeros((101, 101)))
    fast = config(
        terrain=str(small),
        terrain_size=(10.0, 10.0),
        terrain_height=0.01,
        driver="straight",
        start=(3.8, 0.0, 0.0),
        duration=120.0,
        timestep=0.005,
        lidar_beams=2,
    )
    until = failing(fast)
    assert failing(fast.alone(duration=until)) == until, "in the last batch as in any other"


def failing(run: Run) -> float:
    """The time at which a run has failed at the edge of the map [s]."""
    batches: list[Batch] = []
    with EpisodeProcess(run) as process:
        process.begin()
        with pytest.raises(RunFailed, match="reached the edge of the map"):
            batches += (batch for (batch,) in process.batches())
    return batches[-1].truth.time_ns / 1e9


def test_known_error_of_the_child_arrives_as_itself() -> None:
    on_a_wall = config(terrain="maze", start=(10.1, 3.0, 0.0))
    with EpisodeProcess(on_a_wall) as process, pytest.raises(UsageError, match="is inside hazard_"):
        process.begin()


def test_death_of_the_child_fails_the_run() -> None:
    with EpisodeProcess(config(duration=1000.0)) as process:
        process.begin()
        batches = process.batches()
        next(batches)
        for child in multiprocessing.active_children():
            child.kill()
        with pytest.raises(RunFailed, match="simulation process died"):
            list(batches)
    with EpisodeProcess(config(duration=1000.0)) as process:
        process.begin()  # and left early
    assert multiprocessing.active_children() == []


def test_each_rover_of_a_world_gets_its_own_orders_and_its_own_batches() -> None:
    shared = config(terrain="flat", driver="cmd_vel", lidar_beams=2, duration=1.0)
    two = fleet(shared, parse_rovers(("leo:a,driver=goal", "rover_zero4wd:b,x=2,y=0"), shared.rover))
    with EpisodeProcess(two) as process:
        assert [begun.info.start[0] for begun in process.begin()] == [0.0, 2.0]
        path = []
        for index, batches in enumerate(process.batches()):
            path.append([batch.truth.path_length for batch in batches])
            if index == 2:
                process.rovers[1].command(Twist(linear=0.4))
            if index == 12:
                process.rovers[1].command(Twist(linear=0.9))  # in the same period, and forgotten
                assert process.rovers[1].reset() == 13 * CONTROL_PERIOD_NS
            if index == 15:
                process.rovers[1].reset()
                process.rovers[1].command(Twist(linear=0.4))  # after the reset, so that it holds
        assert process.rovers[1].reset() is None, "the episode is over"
    assert max(still for still, _ in path) < 1e-3
    assert path[2][1] < 1e-3 < path[4][1]
    assert path[12][1] > 0.1
    assert path[15][1] - path[12][1] < 0.01, "the command in force is forgotten"
    assert path[-1][1] - path[15][1] > 0.01
    assert [batch.truth.resets for batch in batches] == [0, 2]
    x = [batch.truth.position[0] for batch in batches]
    assert x == pytest.approx([0.0, 2.0], abs=0.08)
