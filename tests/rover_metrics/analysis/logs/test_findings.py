"""What is told of the times of a file, at the edges of what is odd."""

import pandas as pd
import pytest

from rover_metrics.analysis.logs.findings import describe_time
from rover_metrics.analysis.logs.header import shown
from rover_metrics.analysis.logs.parsing import Tally
from rover_metrics.analysis.metric import STAMP

EVERY = "not every second"
SHORT, LONG = "short gap", "long gap"


def told(stamps: list[float], gap: float = 10.0) -> list[str]:
    return describe_time(pd.DataFrame({STAMP: stamps}, index=range(2, 2 + len(stamps))), gap)


@pytest.mark.parametrize(
    ("stamps", "expected"),
    [
        ([5], ["a single row: no rate, no interval"]),
        ([0, 1, 2], []),
        ([0, 1, 2, 3.5], []),
        (
            [0, 1, 2, 3.501, 4.501],
            ["1 short gap (line 5): up to 1.501 s, rates are over the time that passed"],
        ),
        (
            [0, 1, 2, 12, 13, 20],
            ["2 short gaps (first on line 5): up to 10 s, rates are over the time that passed"],
        ),
        (
            [0, 1, 2, 12.001, 13, 33],
            ["2 long gaps (first on line 5): over 10 s, an episode begins there"],
        ),
        (
            [0, 1, 1, 0, 1, 0],
            [
                "1 duplicate timestamp (line 4): the later row counts",
                "2 backward timestamps (first on line 5): an episode begins there",
            ],
        ),
        (
            [0, 0.1, 0.2, 0.3, 0.5],
            [
                "1 short gap (line 6): up to 0.2 s, rates are over the time that passed",
                "a row every 0.1 s, not every second",
            ],
        ),
        ([0, 1.009, 2.018], []),
        ([0, 0.989, 1.978], ["a row every 0.989 s, not every second"]),
        ([0, 2, 3, 4, 6, 8, 10, 10.5], ["a row every 2 s, not every second"]),
        ([3, 3], ["1 duplicate timestamp (line 3): the later row counts"]),
        ([1e9, 1e9 + 1], []),
        ([1e9 + 1, 1e9 + 2], ["wall-clock timestamps: the node ran without use_sim_time"]),
    ],
)
def test_gaps_duplicates_rates_and_clocks_are_told(stamps: list[float], expected: list[str]) -> None:
    assert told(stamps) == expected


def test_a_tally_keeps_the_first_line_and_its_example() -> None:
    tally = Tally()
    for lines, example in (([], "a"), ([4, 7], "b"), ([9], "c")):
        tally.add(pd.Index(lines, dtype="int64"), example)
    assert (tally.count, tally.first, tally.example) == (3, 4, "b")


def test_a_piece_of_a_file_is_shown_in_sixty_characters() -> None:
    assert shown("x" * 60) == repr("x" * 60)
    assert shown("x" * 60 + "\n") == repr("x" * 60 + "...")
    assert shown("a\x1b\n") == r"'a\x1b\n'"
