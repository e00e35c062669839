"""What is told of the times of a file, at the edges of what is odd."""

import pandas as pd

from rover_metrics.analysis.logs.findings import describe_time
from rover_metrics.analysis.logs.header import shown
from rover_metrics.analysis.logs.parsing import Tally
from rover_metrics.analysis.metric import STAMP
from tests.support.snapshots import check_snapshot


def told(stamps: list[float], gap: float = 10.0) -> list[str]:
    return describe_time(pd.DataFrame({STAMP: stamps}, index=range(2, 2 + len(stamps))), gap)


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
    lines = (f"{stamps}\n" + "".join(f"  {odd}\n" for odd in told(stamps)) for stamps in TIMES)
    check_snapshot("times_of_logs.txt", "".join(lines))


def test_a_tally_keeps_the_first_line_and_its_example() -> None:
    tally = Tally()
    for lines, example in (([], "a"), ([4, 7], "b"), ([9], "c")):
        tally.add(pd.Index(lines, dtype="int64"), example)
    assert (tally.count, tally.first, tally.example) == (3, 4, "b")


def test_a_piece_of_a_file_is_shown_in_sixty_characters() -> None:
    assert shown("x" * 60) == repr("x" * 60)
    assert shown("x" * 60 + "\n") == repr("x" * 60 + "...")
    assert shown("a\x1b\n") == r"'a\x1b\n'"
