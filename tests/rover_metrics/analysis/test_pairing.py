"""Which logs are taken for partners."""

from pathlib import Path

import numpy as np
import pytest

from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.pairing import PairingError, pair


def logs(*runs: str) -> list[Log]:
    """Logs of runs such as "leo rocky 3 0.5"; "" has no record."""
    keys = ("robot", "terrain", "seed", "difficulty")
    return [
        Log(
            Path("x.csv"),
            np.zeros(1),
            {},
            np.zeros(1, np.int64),
            arguments=dict(zip(keys, run.split(), strict=False)),
        )
        for run in runs
    ]


@pytest.mark.parametrize(
    ("first", "second", "pairs"),
    [
        (("leo rocky 1", "leo rocky 2"), ("zero rocky 2", "zero rocky 1"), ((0, 1), (1, 0))),
        (("leo rocky 1",), ("leo sand 1",), ((0, 0),)),
        (("leo rocky 1 0.2", "leo rocky 1 0.8"), ("leo sand 1 0.8", "leo sand 1 0.2"), ((0, 1), (1, 0))),
        (("leo rocky 1", "leo sand 1"), ("zero sand 1", "zero rocky 1"), ((0, 1), (1, 0))),
        (("leo rocky 1", "leo sand 2"), ("zero sand 1", "zero rocky 2"), ()),
        (("leo rocky 1", "leo sand 2"), ("zero rocky 1", "zero rocky 2"), ()),
        (("leo rocky 1", "leo rocky 2"), ("zero rocky 1", "zero sand 2"), ()),
        (("leo rocky 1", "leo rocky 1"), ("zero rocky 1", "zero rocky 1"), ()),
        (("leo rocky 1", "leo rocky 2"), ("zero rocky 1",), ()),
        (("leo rocky 1", "leo rocky 2"), ("zero rocky 1", "zero rocky 3"), ()),
        (("leo rocky 1", ""), ("zero rocky 1", "zero rocky 2"), ()),
    ],
)
def test_logs_of_one_seed_are_partners_if_each_has_exactly_one(
    first: tuple[str, ...], second: tuple[str, ...], pairs: tuple[tuple[int, int], ...]
) -> None:
    assert pair(logs(*first), logs(*second), "seed") == pairs
    assert pair(logs(*first), logs(*second), "none") == ()


def test_logs_are_paired_by_their_order_on_request() -> None:
    assert pair(logs("", ""), logs("", ""), "order") == ((0, 0), (1, 1))
    with pytest.raises(PairingError, match="equal size, not 2 and 1 logs"):
        pair(logs("", ""), logs(""), "order")
