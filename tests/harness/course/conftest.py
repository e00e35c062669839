from collections.abc import Sequence
from functools import cache
from pathlib import Path

import pytest

from harness.course.attempt import attempt
from harness.course.drive import cases_of, drive_all
from harness.course.entry import find_entry
from harness.course.receipt import Receipt, receipt_of, write_receipt
from harness.course.result import EpisodeResult
from harness.course.tracks import find_track
from harness.workers import workers_of


def driven(entry: str, track: str, seeds: Sequence[int] = (0,)) -> list[EpisodeResult]:
    return [_driven(entry, track, seed) for seed in seeds]


@cache
def _driven(entry: str, track: str, seed: int) -> EpisodeResult:
    return attempt(find_track(track).cases(seed + 1)[seed], entry=find_entry(entry))


@pytest.fixture(scope="session")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The receipt of `straight` on two worlds of two tracks."""
    entry, path = find_entry("straight"), tmp_path_factory.mktemp("course") / "straight.json"
    cases = cases_of([find_track("barn"), find_track("rocky")], entry, 2)
    with workers_of("local", jobs=1) as workers:
        results = drive_all(cases, entry, workers, lambda *_: None)
    receipt: Receipt = receipt_of(entry, results)
    write_receipt(receipt, path)
    return path
