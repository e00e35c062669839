"""Runs over a scripted episode: 2 s without physics, in which a rock hazard is touched at 1.02 s."""

import math
from collections.abc import Callable, Generator, Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.episode import direct, episode, stream
from harness.episode.batch import Batch, EpisodeInfo
from harness.samples import (
    ContactEvent,
    Imu,
    LaserScan,
    Odometry,
    Pose,
    Sample,
    Tick,
    Truth,
    TruthState,
    Twist,
)
from harness.scenario.case import Case, plan
from harness.spec.run import Run

BATCH_NS = 50_000_000
INFO = EpisodeInfo("model", "terrain", 3, (40.0, 40.0), (0.0, 0.0, 0.0))
TOUCH = ContactEvent(
    "hazard", 1_020_000_000, 1_040_000_000, "wheel_FL", "hazard_3", 5.0, (0.1, 0.2, 0.0)
)
SPEED = 0.5  # [m/s] along x
TILT = math.radians(30.0)  # of the last pose

MakeCases = Callable[..., list[Case]]


class Scripted:
    """Drives at SPEED along x for 2 s, level until the last 50 ms."""

    seen: list[Run]
    wanted: object = None  # samples, by whoever drove it last
    number = 0

    def __init__(self, config: Run, samples: object = None) -> None:
        self.info, type(self).wanted = INFO, samples
        self.seen.append(config)

    def batches(self) -> Iterator[Batch]:
        for index in range(1, 41):
            stamp = index * BATCH_NS
            x, touched = SPEED * stamp / 1e9, stamp >= TOUCH.end_ns
            truth = Truth(stamp, x, (x, 0.0, 0.0), hazard_contacts=int(touched))
            events = (TOUCH,) if stamp == 1_050_000_000 else ()
            yield Batch((Tick(stamp, _samples(stamp, x, index == 40)),), truth, events, ())


def _samples(stamp: int, x: float, is_tilted: bool) -> tuple[Sample, ...]:
    half = 0.5 * TILT if is_tilted else 0.0
    return (
        LaserScan(stamp, np.full(8, 2.0, dtype=np.float32)),
        Imu(stamp, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 9.8)),
        Pose(stamp, (x, 0.0, 0.0), (math.sin(half), 0.0, 0.0, math.cos(half))),
        Odometry(stamp, x, 0.0, 0.0, Twist(SPEED, 0.0)),
        TruthState(stamp, False, False, False, 0.0, SPEED, x, (0.1, -0.2, 0.3, -0.4), 0.01),
    )


@pytest.fixture
def driven(monkeypatch: pytest.MonkeyPatch) -> list[Run]:
    """Lets the scripted episode stand for every other; gives the configurations that were driven."""
    seen: list[Run] = []
    monkeypatch.setattr(Scripted, "seen", seen, raising=False)
    monkeypatch.setattr(direct, "Episode", Scripted)
    monkeypatch.setattr(episode, "episodes_of", lambda run, *_: (Scripted(run),))

    def together(made: Iterable[Scripted], *_: object, **__: object) -> Generator[tuple[Batch, ...]]:
        yield from zip(*(each.batches() for each in made), strict=True)

    def side_by_side(*made: Any, **_: object) -> SimpleNamespace:  # noqa: ANN401 - as it is called
        return SimpleNamespace(batches=lambda: together(*made), hasten=lambda: None)

    for module in (direct, stream):
        monkeypatch.setattr(module, "Together", side_by_side)
    return seen


@pytest.fixture
def make_cases(tmp_path: Path) -> MakeCases:
    """Writes a scenario of 2 s and plans its runs."""

    def make(expect: str, more: str = "", name: str = "two") -> list[Case]:
        path = tmp_path / f"{name}.scenario.yaml"
        path.write_text(f"about: a test\nterrain: flat\nduration: 2\nexpect: {expect}\n{more}\n")
        return plan([path])

    return make


def cases_with(make_cases: MakeCases, folder: Path, parameters: str) -> list[Case]:
    """Runs with a parameter file in the folder of the scenario, and without one."""
    (folder / "near.yaml").write_text(parameters)
    return make_cases("{log.Total Collisions: {max: 0}}", "matrix: {params: [near.yaml, null]}")
