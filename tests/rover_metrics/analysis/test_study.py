from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.study import labels

MakeLog = Callable[..., Log]

SHORT = "a" * 18 + "..." + "b" * 19
RUN = {"robot": "leo", "terrain": "rocky", "difficulty": 0.5, "seed": 7}


def log_at(path: str, arguments: dict[str, object] | None = None) -> Log:
    return Log(Path(path), np.zeros(1), {}, np.zeros(1, np.int64), arguments=arguments or {})


def named(*paths: str) -> list[str]:
    return labels([log_at(path) for path in paths])


@pytest.mark.parametrize(
    ("stem", "changed", "label"),
    [
        ("metrics_log_20250116_120457", {}, "leo rocky 0.5 seed 7"),
        ("metrics_log_20250116_120457_2", {}, "leo rocky 0.5 seed 7"),
        ("metrics_log_20250116_120457", {"terrain": "/maps/yard.tif"}, "leo yard seed 7"),
        ("metrics_log_20250116_120457", {"difficulty": None}, "leo rocky seed 7"),
        ("baseline", {}, "baseline"),
        ("metrics_log_20250116_120457-rerun", {}, "metrics_log_20250116_120457-rerun"),
    ],
)
def test_a_name_that_a_person_gave_comes_first_then_what_was_driven_then_the_time(
    stem: str, changed: dict[str, object], label: str
) -> None:
    assert labels([log_at(f"/d/{stem}.csv", RUN | changed)]) == [label]
    assert named(f"/d/{stem}.csv") == [stem]
    assert labels([log_at(f"/d/{stem}.csv", {"seed": 7})]) == [stem]


def test_drives_that_are_alike_are_told_apart_by_their_times() -> None:
    twice = [log_at(f"/d/metrics_log_20250116_12045{i}.csv", RUN) for i in range(2)]
    other = log_at("/d/metrics_log_20250116_120459.csv", RUN | {"seed": 8})
    assert labels([*twice, other]) == [
        "leo rocky 0.5 seed 7, 20250116_120450",
        "leo rocky 0.5 seed 7, 20250116_120451",
        "leo rocky 0.5 seed 8",
    ]


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (("/data/a/1.csv", "/data/b/2.csv"), ["1", "2"]),
        # Same names take as many folders as tell them apart, those that look the same a number.
        (("/x/a/run/1.csv", "/x/b/run/1.csv", "/x/2.csv"), ["a/run/1", "b/run/1", "2"]),
        (("/1.csv", "/a/1.csv", "/b/a/1.csv"), ["1", "a/1", "b/a/1"]),
        (("/d/1.csv", "/d/1.txt"), ["d/1 (1)", "d/1 (2)"]),
        ((f"/{'a' * 20}{'b' * 20}.csv",), ["a" * 20 + "b" * 20]),
        ((f"/{'a' * 20}c{'b' * 20}.csv",), [SHORT]),
        (tuple(f"/d/{'a' * 50}{i}{'b' * 50}.csv" for i in "12"), [f"{SHORT} (1)", f"{SHORT} (2)"]),
        (("/d/a\x1b[31m\nb.csv",), ["a?[31m?b"]),
    ],
)
def test_a_log_is_called_by_its_stem_and_by_what_tells_it_apart(
    paths: tuple[str, ...], names: list[str]
) -> None:
    assert named(*paths) == names
