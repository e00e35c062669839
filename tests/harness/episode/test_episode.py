"""Episodes on small runs: what is due when, resets, plans, contacts, and what ends them."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from harness.drivers.base import Observation
from harness.drivers.scripted import Straight
from harness.episode.episode import Episode
from harness.robots import ROVERS
from harness.samples import (
    ActorPoses,
    GroundTruth,
    Imu,
    JointStates,
    LaserScan,
    Odometry,
    Place,
    Pose,
    Sample,
    TruthState,
    Twist,
)
from harness.spec.run import Run
from tests.support.exact import as_bytes

LIGHT = {"terrain": "flat", "driver": "straight", "duration": 1.0, "lidar_beams": 8}


def config(**changes: object) -> Run:
    return Run.of(**LIGHT | changes)


def samples(run: Run, kind: type[Sample]) -> list[Sample]:
    ticks = [tick for batch in Episode(run).batches() for tick in batch.ticks]
    return [sample for tick in ticks for sample in tick.samples if isinstance(sample, kind)]


@pytest.mark.parametrize("robot", ROVERS)
def test_each_tick_of_10_ms_has_the_samples_that_are_due_in_publishing_order(robot: str) -> None:
    """At the rates of docs/topics.md, in batches of control periods, the last of what is left."""
    periods = {LaserScan: 5, Imu: 1, Pose: 2, Odometry: 100 // ROVERS[robot].odometry_rate}
    periods |= {GroundTruth: 2, JointStates: 2, TruthState: 5}
    batches = [b.ticks for b in Episode(config(robot=robot, imu_rate=100, duration=0.52)).batches()]
    assert [len(batch) for batch in batches] == [5] * 10 + [2]
    for number, tick in enumerate((tick for batch in batches for tick in batch), 1):
        assert tick.stamp_ns == 10_000_000 * number
        due = [(kind, tick.stamp_ns) for kind, period in periods.items() if number % period == 0]
        assert [(type(sample), sample.stamp_ns) for sample in tick.samples] == due


@pytest.mark.parametrize(("timeout", "shortest", "longest"), [(None, 0.4, 0.7), (0.5, 0.1, 0.2)])
def test_cmd_vel_driver_stands_until_commanded_and_from_the_timeout_on(
    timeout: float | None, shortest: float, longest: float
) -> None:
    episode = Episode(config(driver="cmd_vel", duration=3.0, cmd_vel_timeout=timeout))
    path = []
    for index, batch in enumerate(episode.batches()):
        path.append(batch.truth.path_length)
        if index == 19:
            episode.command(Twist(linear=0.3))
    assert path[19] < 1e-3
    assert shortest < path[-1] < longest  # of 0.3 m/s for 2 s, or for 0.5 s
    episode.reset(Place(5.0, -3.0, 1.0))
    assert episode.simulation.position[:2] == pytest.approx((5.0, -3.0), abs=0.02)
    assert episode.simulation.yaw == pytest.approx(1.0, abs=0.02)


def test_what_is_planned_happens_at_the_next_control_period() -> None:
    commands = ((0.31, 0.0, 0.5), (0.0, 0.4, 0.0), (0.6, 9.0, 0.0), (0.6, 0.3, 0.0))
    planned = Episode(config(driver="cmd_vel", duration=0.75, commands=commands, resets=(0.6, 0.4)))
    by_hand = Episode(config(driver="cmd_vel", duration=0.75))
    at_tick = {0: (0.4, 0.0), 35: (0.0, 0.5), 60: (0.3, 0.0)}
    batches = by_hand.batches()
    for index, batch in enumerate(planned.batches()):
        if index * 5 in (40, 60):
            by_hand.reset()
        if index * 5 in at_tick:
            by_hand.command(Twist(*at_tick[index * 5]))
        expected = next(batches)
        assert as_bytes(batch.ticks) == as_bytes(expected.ticks)
        assert batch.truth == expected.truth
    assert batch.truth.resets == 2


def test_people_begin_anew_with_a_reset_and_walk_on_when_the_rover_is_put_elsewhere() -> None:
    def told(*places: Place | None) -> list[tuple[int, float]]:
        episode = Episode(config(duration=1.0, actors=("g=3,0/3,4",)))
        found = []
        for index, batch in enumerate(episode.batches(), 1):
            people = [s for t in batch.ticks for s in t.samples if isinstance(s, ActorPoses)]
            found += [(s.stamp_ns // 10**7, round(s.position[0][1], 9)) for s in people]
            if index == 10:
                for place in places:
                    episode.reset(place)
        return found

    walked = told()
    assert len(walked) == 30
    assert walked == [(tick, tick / 100) for tick, _ in walked]
    assert told(Place(1.0, 1.0, 0.0)) == walked
    assert told(None) == [(tick, (tick - 50 if tick > 50 else tick) / 100) for tick, _ in walked]


@pytest.mark.parametrize(
    "own",
    [
        {"robot": "leo", "driver": "wander", "actors": ["random"]},
        {"robot": "rover_zero4wd", "driver": "swing"},
        {"robot": "leo", "driver": "figure8", "soil": "dry_sand"},
        {
            "robot": "husky",
            "driver": "dwa",
            "goal_area": (-4.0, 4.0, -4.0, 4.0),
            "actuators": "real",
            "faults": ["cmd_vel:dropout=0.5"],
        },
    ],
)
def test_after_a_reset_the_rover_drives_as_it_did_at_first(own: dict[str, Any]) -> None:
    count = 67  # of periods of 50 ms: after 3 s a driver may take itself for stuck
    run = config(terrain="rocky", duration=0.1 * count, seed=3, **own)
    episode, batches = Episode(run), []
    for batch in episode.batches():
        batches.append(batch)
        if len(batches) == count:
            episode.reset()
    first, second = batches[:count], batches[count:]
    offset_ns = count * 50_000_000
    assert [t.stamp_ns for b in batches for t in b.ticks] == [
        10**7 * n for n in range(1, 10 * count + 1)
    ]
    for before, after in zip(first, second, strict=True):
        assert after.truth.position == before.truth.position
        for kind in (LaserScan, Imu):  # of the same phase at both times
            one, other = (
                next(s for s in batch.ticks[-1].samples if type(s) is kind) for batch in (before, after)
            )
            assert as_bytes(replace(one, stamp_ns=one.stamp_ns + offset_ns)) == as_bytes(other)
    assert second[-1].truth.path_length == pytest.approx(2 * first[-1].truth.path_length)
    assert [b.truth.resets for b in (first[-1], second[0])] == [0, 1]


@pytest.mark.parametrize("robot", ROVERS)
def test_odometry_does_not_see_a_reset(robot: str) -> None:
    driven = {}
    for resets in (False, True):
        episode = Episode(config(robot=robot, duration=1.5))
        readings = []
        for index, batch in enumerate(episode.batches()):
            readings += [s for t in batch.ticks for s in t.samples if isinstance(s, Odometry)]
            if resets and index == 14:
                episode.reset()
        assert all(0.0 <= b.x - a.x < 0.03 for a, b in pairwise(readings))
        driven[resets] = readings
    half = len(driven[True]) // 2
    assert driven[True][half - 1] == driven[False][half - 1]
    assert driven[True][-1].x == pytest.approx(2 * driven[True][half - 1].x, abs=0.01)


def on_its_roof(**changes: object) -> Episode:
    """A rover that begins to scrape the ground with its body."""
    episode = Episode(config(driver="cmd_vel", **changes))
    episode.simulation.data.qpos[2:7] = 0.5, 0.0, 1.0, 0.0, 0.0
    return episode


def test_an_event_that_lasts_at_the_end_is_told_with_the_last_batch() -> None:
    *before, last = on_its_roof(duration=0.5).batches()
    (lasting,) = before[-1].open_events
    assert not any(batch.events for batch in before)
    (event,) = last.events
    assert (event.kind, event.start_ns) == (lasting.kind, lasting.start_ns) == ("scrape", event.start_ns)
    assert event.end_ns > lasting.end_ns
    assert last.open_events == ()
    assert last.truth.scrapes == 1


def test_a_driver_is_told_the_time_since_its_drive_began_and_what_it_looks_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told: list[Observation] = []

    def looks_on(_: Straight, observation: Observation) -> Twist:
        told.append(observation)
        return Twist(0.2)

    monkeypatch.setattr(Straight, "command", looks_on)
    monkeypatch.setattr(Straight, "senses", frozenset({Odometry}))
    for _ in Episode(config(duration=0.3, resets=[0.15])).batches():
        pass
    assert [each.time_ns / 1e6 for each in told] == [0, 50, 100, 0, 50, 100]
    assert [Odometry in each.readings for each in told] == [False, True, True] * 2
