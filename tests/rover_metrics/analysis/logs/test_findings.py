"""What is told of the times of a file at the edges of what is odd, and of columns that contradict."""

from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from rover_metrics.analysis.logs.findings import describe_consistency, describe_time
from rover_metrics.analysis.logs.header import shown
from rover_metrics.analysis.logs.parsing import Tally
from rover_metrics.analysis.logs.reading import read_log
from rover_metrics.analysis.metric import METRICS, STAMP
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, Thresholds
from rover_metrics.log.session_record import COMPLETE, write_record
from tests.support.snapshots import check_snapshot

Values = Iterable[float]
TIMES: tuple[list[float], ...] = (
    [5],
    [0, 1, 2],
    [0, 1, 2, 3.5],
    [0, 1, 2, 3.501, 4.501],
    [0, 1, 2, 12, 13, 20],
    [0, 1, 2, 12.001, 13, 33],
    [0, 1, 1, 0, 1, 0],
    [0, 0.1, 0.2, 0.3, 0.5],
    [0, 1.009, 2.018],
    [0, 0.989, 1.978],
    [0, 2, 3, 4, 6, 8, 10, 10.5],
    [3, 3],
    [1e9, 1e9 + 1],
    [1e9 + 1, 1e9 + 2],
)


def test_gaps_duplicates_rates_and_clocks_are_told() -> None:
    lines = []
    for stamps in TIMES:
        rows = pd.DataFrame({STAMP: stamps}, index=range(2, 2 + len(stamps)))
        lines += [f"{stamps}\n", *(f"  {odd}\n" for odd in describe_time(rows, 10.0))]
    check_snapshot("times_of_logs.txt", "".join(lines))


def test_a_tally_keeps_the_first_line_and_a_piece_of_a_file_is_shown_in_sixty_characters() -> None:
    tally = Tally()
    for lines, example in (([], "a"), ([4, 7], "b"), ([9], "c")):
        tally.add(pd.Index(lines, dtype="int64"), example)
    assert (tally.count, tally.first, tally.example) == (3, 4, "b")
    assert shown("x" * 60) == repr("x" * 60)
    assert shown("x" * 60 + "\n") == repr("x" * 60 + "...")


def told(thresholds: Thresholds = DEFAULT_THRESHOLDS, **columns: Values) -> list[str]:
    named = {name.replace("_", " "): list(values) for name, values in columns.items()}
    rows = pd.DataFrame(named, dtype=np.float32)
    return describe_consistency(rows.set_index(rows.index + 2), thresholds)


def rough(flags: Values, levels: Values) -> list[str]:
    return told(Is_Rough_Terrain=flags, IMU_Acceleration_Magnitude=levels)


WHAT = (
    "whose Is Rough Terrain contradicts IMU Acceleration Magnitude and rough_terrain_threshold 15 m/s^2"
)


@pytest.mark.parametrize(
    ("flags", "levels", "where", "fit"),
    [
        ([0, 1, 1], [4, 6, 20], ("1 row", "line 3, 1 at 6"), ", such as one between 4 and 6"),
        ([1, 1], [6, 7], ("2 rows", "first on line 2, 1 at 6"), ", such as one below 6"),
        ([0, 0], [16, 17], ("2 rows", "first on line 2, 0 at 16"), ", such as one above 17"),
        ([0, 1, 0], [4, 6, 17], ("2 rows", "first on line 3, 1 at 6"), ""),
        ([1, 0], [14.9998, 3], ("1 row", "line 2, 1 at 14.9998"), ", such as one between 3 and 14.9998"),
    ],
)
def test_a_flag_that_contradicts_its_level_is_told_with_what_would_fit(
    flags: Values, levels: Values, where: tuple[str, str], fit: str
) -> None:
    rows, first = where
    assert rough(flags, levels) == [
        f"{rows} {WHAT} ({first}): another rule or threshold was at work{fit}"
    ]


def test_a_collision_is_below_its_threshold_the_one_that_the_log_had() -> None:
    assert rough([0, 1, 0, 1, np.nan, 0], [14.9, 15.1, 15.0, 15.0, 20, np.nan]) == []
    assert told(Current_Collision_Status=[1, 0, 1], Obstacle_Clearance=[0.1, 0.3, 0.2]) == []
    near: dict[str, Values] = {"Current_Collision_Status": [1, 0], "Obstacle_Clearance": [0.35, 0.5]}
    (finding,) = told(DEFAULT_THRESHOLDS, **near)
    assert "collision_threshold 0.2 m (line 2, 1 at 0.35)" in finding
    assert finding.endswith("such as one between 0.35 and 0.5")
    assert told(Thresholds(collision_threshold=0.4), **near) == []
    (alone,) = told(Current_Collision_Status=[1], Obstacle_Clearance=[0.35])
    (never,) = told(Current_Collision_Status=[0], Obstacle_Clearance=[0.15])
    assert (alone[-23:], never[-23:]) == (" such as one above 0.35", " such as one below 0.15")


def test_the_records_threshold_is_what_counts(
    write_log: Callable[..., Path], row: Callable[..., str]
) -> None:
    log = write_log(lines=[row(i, Is_Rough_Terrain=1) for i in range(7)])
    assert "5 rows whose Is Rough Terrain" in " ".join(read_log(log, [METRICS["DT"]]).findings)
    write_record(log, COMPLETE, {"thresholds": {"rough_terrain_threshold": 5.0}})
    assert read_log(log).findings == ()


def smoothness(seconds: int, window: int | None, spread: float = 3.0) -> list[str]:
    """A node's two columns: 19 or 21 samples a second, four decimals, a mean over so many of them."""
    samples = np.random.default_rng(0).normal(11.0, spread, 20 * seconds + 1)
    ends = [20 * second + second % 2 for second in range(1, seconds + 1)]
    means = [samples[max(0, end - window) if window else 0 : end].mean() for end in ends]
    rows = pd.DataFrame(
        {
            "Smoothness Metric": [round(float(samples[:end].sum()), 4) for end in ends],
            "Current Smoothness": np.round(means, 4),
        }
    )
    return describe_consistency(rows, DEFAULT_THRESHOLDS)


def test_a_mean_since_the_start_is_told_from_a_window() -> None:
    (finding,) = smoothness(60, None)
    assert finding.startswith("Current Smoothness is the mean since the start")
    for window in (100, 200):
        assert smoothness(60, window) == []
    assert smoothness(60, None, spread=0.0) == []  # at rest both are the same
    assert smoothness(16, None) == []  # nine rows beyond 150 samples
    assert len(smoothness(17, None)) == 1
    assert len(smoothness(3000, None)) == 1  # at the end the decimals say nothing
