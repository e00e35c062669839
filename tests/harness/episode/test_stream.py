import gc
import weakref
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.base.errors import RunFailed
from harness.base.sim_time import CONTROL_PERIOD_NS
from harness.episode.assembly import fleet, injector
from harness.episode.batch import Batch
from harness.episode.episode import episodes_of
from harness.episode.stream import EpisodeStream, Progress, RoverOrders
from harness.episode.together import Together
from harness.samples import Imu, JointStates, LaserScan, Place, Pose, Twist
from harness.sensors.battery import Battery
from harness.sensors.gnss import GnssFix
from harness.spec.fleet import parse_rovers
from harness.spec.rover import RoverSetup
from harness.spec.run import Run
from tests.support.exact import as_bytes


def config(**changes: object) -> Run:
    values: dict[str, object] = {"terrain": "rocky", "duration": 2.0}
    return Run.of(**{**values, **changes})


@pytest.mark.parametrize("prompt", [False, True])
def test_a_rover_is_put_and_given_goals_at_the_times_that_are_told(prompt: bool) -> None:
    run = config(terrain="flat", driver="goal", duration=6.0, lidar_beams=2)
    stream = EpisodeStream(run, prompt=prompt)
    (rover,) = stream.rovers
    stream.begin()
    poses = []
    for index, (batch,) in enumerate(stream.batches()):
        poses += [s for tick in batch.ticks for s in tick.samples if isinstance(s, Pose)]
        if index == 2:
            put = rover.put(Place(5.0, 3.0, 1.0))
        if index == 20:
            again = rover.put(Place(5.0, -3.0, 1.0))
            headed = rover.head_for(Place(6.0, -3.0, 0.0))  # in the same period
    assert rover.put(Place(0.0, 0.0, 0.0)) is rover.head_for(Place(0.0, 0.0, 0.0)) is None
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
    orders = RoverOrders(Progress(total=8, taken=2), rover)
    orders.command(Twist(0.5, 0.1))
    assert orders.reset() == 2 * CONTROL_PERIOD_NS
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
    stream = EpisodeStream(run)
    stream.begin()
    with pytest.raises(RunFailed, match="reached the edge of the map"):
        batches += (batch for (batch,) in stream.batches())
    return batches[-1].truth.time_ns / 1e9


def test_each_rover_of_a_world_gets_its_own_orders_and_its_own_batches() -> None:
    shared = config(terrain="flat", driver="cmd_vel", lidar_beams=2, duration=1.0)
    two = fleet(shared, parse_rovers(("leo:a,driver=goal", "rover_zero4wd:b,x=2,y=0"), shared.rover))
    stream = EpisodeStream(two, prompt=True)
    assert [begun.info.start[0] for begun in stream.begin()] == [0.0, 2.0]
    path = []
    for index, batches in enumerate(stream.batches()):
        path.append([batch.truth.path_length for batch in batches])
        if index == 2:
            stream.rovers[1].command(Twist(linear=0.4))
        if index == 12:
            stream.rovers[1].command(Twist(linear=0.9))  # in the same period, and forgotten
            assert stream.rovers[1].reset() == 13 * CONTROL_PERIOD_NS
        if index == 15:
            stream.rovers[1].reset()
            stream.rovers[1].command(Twist(linear=0.4))  # after the reset, so that it holds
    assert stream.rovers[1].reset() is None, "the episode is over"
    assert max(still for still, _ in path) < 1e-3
    assert path[2][1] < 1e-3 < path[4][1]
    assert path[12][1] > 0.1
    assert path[15][1] - path[12][1] < 0.01, "the command in force is forgotten"
    assert path[-1][1] - path[15][1] > 0.01
    assert [batch.truth.resets for batch in batches] == [0, 2]
    x = [batch.truth.position[0] for batch in batches]
    assert x == pytest.approx([0.0, 2.0], abs=0.08)


@pytest.mark.parametrize(
    "own",
    [
        "leo:b,driver=goal,noise=hardware,sensors=gnss,fault=motor.left:weak=0.2@1,fault=pose:spike=2",
        "husky:b,actuators=real,surface=wet_grass,sensors=battery,fault=cmd_vel:dropout=0.5,fault=scan:dropout=0.5",
    ],
)
def test_a_rover_of_a_fleet_does_and_tells_what_it_would_alone_by_its_own_seed(own: str) -> None:
    led = {"driver": "goal", "goal_area": (2.0, 3.0, 2.0, 3.0), "targets": ["post:x=2.5,y=2.5"]}
    shared = config(terrain="flat", lidar_beams=16, **led)
    words = ("rover_zero4wd:a", f"{own},x=2,y=-4,yaw=2")
    two = fleet(shared, parse_rovers(words, shared.rover))
    alone = two.but(rovers=two.rovers[1:], seed=two.own_seed(1))
    for one, other in zip(told(two, 1), told(alone, 0), strict=True):
        assert [*map(type, one)] == [*map(type, other)]
        for sample, again in zip(one, other, strict=True):
            if isinstance(sample, Pose | Imu | LaserScan | JointStates | GnssFix | Battery | Place):
                assert numbers(sample) == pytest.approx(numbers(again), abs=0.01, nan_ok=True)


def told(run: Run, number: int) -> Iterator[tuple[object, ...]]:
    """The goals of each period of a rover, and the samples of each tick that its faults leave."""
    faults = injector(run, number)
    for batches in Together(episodes_of(run)).batches():
        yield batches[number].goals
        yield from (faults.corrupt(tick).samples for tick in batches[number].ticks)


def numbers(sample: object) -> NDArray[np.float64]:
    values = (getattr(sample, name) for name in sample.__match_args__)  # type: ignore[attr-defined] # as all
    return np.hstack([np.ravel(np.array(v, float)) for v in values if not isinstance(v, str)])


def test_orders_to_a_fleet_that_is_simulated_ahead_give_the_bytes_of_one_that_is_not() -> None:
    shared = config(driver="goal", lidar_beams=8, duration=1.5)
    two = fleet(shared, parse_rovers(("leo:a", "rover_zero4wd:b,x=3,y=0"), shared.rover))

    def driven(index: int, *, prompt: bool) -> tuple[int | None, list[bytes]]:
        stream, told, at_ns = EpisodeStream(two, prompt=prompt), list[bytes](), None
        stream.begin()
        for number, batches in enumerate(stream.batches()):
            told += map(as_bytes, batches)
            if number == index:
                stream.rovers[0].head_for(Place(-2.0, 1.0, 0.0))
                at_ns = stream.rovers[1].put(Place(4.0, 3.0, 1.0))
        return at_ns, told

    at_ns, ahead = driven(4, prompt=False)
    assert at_ns is not None
    assert driven(at_ns // CONTROL_PERIOD_NS - 1, prompt=True) == (at_ns, ahead)


def test_a_process_of_many_runs_keeps_the_world_of_none_until_garbage_is_collected() -> None:
    gc.disable()
    try:
        stream = EpisodeStream(config(lidar_beams=2, resets=[1.5], link_losses=[(1.6, 1.0)]))
        (episode,) = stream.begin()
        stream.rovers[0].put(Place(1.0, 0.0, 0.0))
        next(stream.batches())
        world = weakref.ref(episode.simulation)
        del episode, stream
        assert world() is None
    finally:
        gc.enable()
