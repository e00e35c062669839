"""How logs are named, which are partners."""

from pathlib import Path

import numpy as np
import pytest

from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.pairing import pair
from rover_metrics.analysis.study import labels
from rover_metrics.errors import RoverMetricsError

SHORT = "a" * 18 + "..." + "b" * 19
RUN = {"robot": "leo", "terrain": "rocky", "difficulty": 0.5, "seed": 7}
TIME = "metrics_log_20250116_12045"


def log_at(path: str, arguments: dict[str, object] | None = None) -> Log:
    return Log(Path(path), np.zeros(1), {}, np.zeros(1, np.int64), arguments=arguments or {})


@pytest.mark.parametrize(
    ("stem", "changed", "label"),
    [
        (f"{TIME}7", {}, "leo rocky 0.5 seed 7"),
        (f"{TIME}7_2", {}, "leo rocky 0.5 seed 7"),
        (f"{TIME}7", {"terrain": "/maps/yard.tif"}, "leo yard seed 7"),
        (f"{TIME}7", {"difficulty": None}, "leo rocky seed 7"),
        ("baseline", {}, "baseline"),
        (f"{TIME}7-rerun", {}, f"{TIME}7-rerun"),
    ],
)
def test_a_persons_name_for_a_log_comes_first(stem: str, changed: dict[str, object], label: str) -> None:
    assert labels([log_at(f"/d/{stem}.csv", RUN | changed)]) == [label]
    assert labels([log_at(f"/d/{stem}.csv", {"seed": 7})]) == [stem]


def test_drives_that_are_alike_are_told_apart_by_their_times() -> None:
    twice = [log_at(f"/d/{TIME}{i}.csv", RUN) for i in range(2)]
    other = log_at(f"/d/{TIME}9.csv", RUN | {"seed": 8})
    alike = [f"leo rocky 0.5 seed 7, 20250116_12045{i}" for i in range(2)]
    assert labels([*twice, other]) == [*alike, "leo rocky 0.5 seed 8"]


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        # Same names take as many folders as tell them apart, those that look the same a number.
        (("/x/a/run/1.csv", "/x/b/run/1.csv", "/x/2.csv"), ["a/run/1", "b/run/1", "2"]),
        (("/1.csv", "/a/1.csv", "/b/a/1.csv"), ["1", "a/1", "b/a/1"]),
        (("/d/1.csv", "/d/1.txt"), ["d/1 (1)", "d/1 (2)"]),
        ((f"/{'a' * 20}{'b' * 20}.csv",), ["a" * 20 + "b" * 20]),
        (tuple(f"/d/{'a' * 50}{i}{'b' * 50}.csv" for i in "12"), [f"{SHORT} (1)", f"{SHORT} (2)"]),
        (("/d/a\x1b[31m\nb.csv",), ["a?[31m?b"]),
    ],
)
def test_a_log_is_called_by_what_tells_it_apart(paths: tuple[str, ...], names: list[str]) -> None:
    assert labels([log_at(path) for path in paths]) == names


def logs(*runs: str) -> list[Log]:
    """Logs of runs such as "leo rocky 3 0.5"; "" has no record."""
    keys = ("robot", "terrain", "seed", "difficulty")
    return [log_at("x.csv", dict(zip(keys, run.split(), strict=False))) for run in runs]


@pytest.mark.parametrize(
    ("first", "second", "pairs"),
    [
        (("leo rocky 1", "leo rocky 2"), ("zero rocky 2", "zero rocky 1"), ((0, 1), (1, 0))),
        (("leo rocky 1 0.2", "leo rocky 1 0.8"), ("leo sand 1 0.8", "leo sand 1 0.2"), ((0, 1), (1, 0))),
        (("leo rocky 1", "leo sand 1"), ("zero sand 1", "zero rocky 1"), ((0, 1), (1, 0))),
        (("leo rocky 1", "leo sand 2"), ("zero rocky 1", "zero rocky 2"), ()),
        (("leo rocky 1", "leo rocky 2"), ("zero rocky 1", "zero sand 2"), ()),
        (("leo rocky 1", "leo rocky 1"), ("zero rocky 1", "zero rocky 1"), ()),
        (("leo rocky 1", "leo rocky 2"), ("zero rocky 1",), ()),
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
    with pytest.raises(RoverMetricsError, match="equal size, not 2 and 1 logs"):
        pair(logs("", ""), logs(""), "order")
