from collections.abc import Callable, Generator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from harness.base.workers import Workers
from harness.course import attempt as module
from harness.course.drive import cases_of, drive_all
from harness.course.entry import find_entry
from harness.course.receipt import Receipt, receipt_of, write_receipt
from harness.course.referee import Referee
from harness.course.result import EpisodeResult
from harness.course.task import Task
from harness.course.tracks import find_track
from harness.episode.batch import Batch
from harness.world.world import World
from tests.support.once import made_once


class Witness(Referee):
    """A referee that also keeps what it was shown until the episode was over."""

    def __init__(self, task: Task, world: World) -> None:
        super().__init__(task, world)
        self.task, self.world, self.batches = task, world, list[Batch]()

    def take(self, batch: Batch) -> None:
        if not self.ending:
            self.batches.append(batch)
        super().take(batch)


def driven(entry: str, track: str, seeds: Sequence[int] = (0,)) -> list[EpisodeResult]:
    return [witnessed(entry, track, seed)[0] for seed in seeds]


@cache
def witnessed(entry: str, track: str, seed: int) -> tuple[EpisodeResult, Witness]:
    witnesses = list[Witness]()

    def made(task: Task, world: World) -> Witness:
        witnesses.append(Witness(task, world))
        return witnesses[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "Referee", made)
        result = module.attempt(find_track(track).cases(seed + 1)[seed], entry=find_entry(entry))
    return result, witnesses[-1]


class Backwards(Workers):
    """Workers of whom the last is done first: what comes of it is what comes of one."""

    def map(self, work: Callable[[Any], Any], items: Sequence[Any]) -> Generator[Any, None, None]:
        yield from map(work, reversed(items))


@pytest.fixture(scope="session")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The receipt of `straight` on two worlds of two tracks."""
    entry, path = find_entry("straight"), tmp_path_factory.mktemp("course") / "straight.json"

    def made() -> Receipt:
        cases = cases_of([find_track("barn"), find_track("blind")], entry, 2)
        receipt: Receipt = receipt_of(entry, drive_all(cases, entry, Backwards(), lambda *_: None))
        return receipt

    write_receipt(made_once(tmp_path_factory, "straight", made), path)
    return path
