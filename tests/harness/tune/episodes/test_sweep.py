"""How a driven episode ends, and what is kept of it then."""

from collections.abc import Iterator

import numpy as np
import pytest

from harness.base.errors import Diverged, RunFailed
from harness.episode.batch import Batch
from harness.samples import LaserScan, Tick
from harness.truth.traversal import Truth
from harness.tune.episodes.recompute import Collected
from harness.tune.episodes.record import Ending
from harness.tune.episodes.sweep import _drive


class Scripted:
    """An episode of prepared batches, which may fail at the end."""

    def __init__(self, *batches: Batch, error: Exception | None = None) -> None:
        self._batches, self._error = batches, error

    def batches(self) -> Iterator[Batch]:
        yield from self._batches
        if self._error is not None:
            raise self._error


def batch(*, tipped: bool = False) -> Batch:
    scan = LaserScan(0, np.zeros(2, np.float32))
    return Batch((Tick(0, (scan,)),), Truth(tipped_over=tipped))


@pytest.mark.parametrize(
    ("batches", "error", "ending", "scans"),
    [
        ((batch(), batch()), None, Ending.COMPLETE, 2),
        ((batch(), batch(tipped=True), batch()), None, Ending.TIPPED_OVER, 2),
        ((batch(),), RunFailed("off the map"), Ending.LEFT_THE_MAP, 1),
        ((batch(),), Diverged("too fast"), Ending.DIVERGED, 1),
    ],
)
def test_an_episode_is_kept_up_to_its_end_with_how_it_ended(
    batches: tuple[Batch, ...], error: Exception | None, ending: Ending, scans: int
) -> None:
    collected = Collected()

    assert _drive(Scripted(*batches, error=error), collected) is ending  # type: ignore[arg-type]
    assert len(collected.scans) == scans
