"""The figures that a run shows on the terminal."""

import io
import math
import re
from pathlib import Path

import pytest
from rich.console import Console

from harness.cli.console import RunProgress, counted, print_summary
from harness.episode.result import RunResult, TopicCount
from harness.spec.run import Run
from harness.truth.traversal import Truth

TRUTH = Truth(
    time_ns=12_500_000_000,
    path_length=3.456,
    hazard_contacts=2,
    rock_contacts=5,
    scrapes=7,
    hazard_contact_s=0.25,
    rock_contact_s=1.5,
    scrape_s=0.75,
    mean_slip=0.129,
    largest_tilt=math.radians(81.4),
    tipped_over=True,
)
RESULT = RunResult(
    run=Run(),
    mode="direct",
    truth=TRUTH,
    wall_s=2.5,
    waited_s={"/controller_server": 1.575},
    topics={"/scan": TopicCount(12_345, 12_340, 5), "/tf": TopicCount(7), "/imu": TopicCount(9, 9)},
    rows=12,
    log_path=Path("logs/a.csv"),
    last_row={
        "Distance Traveled": 3.4,
        "Total Collisions": 6,
        "Obstacle Clearance": 1.25,
        "Current Velocity": 0.31,
    },
)


def shown(result: RunResult) -> dict[str, list[str]]:
    """The cells of each row of the tables by the first of them, and all other lines."""
    out = io.StringIO()
    print_summary(Console(file=out, width=120), result)
    lines = [line for line in out.getvalue().splitlines() if line.strip()]
    cells = [[cell.strip() for cell in re.split("[│┃]", line)[1:-1]] for line in lines]
    table = {row[0]: row[1:] for row in cells if row}
    return table | {"": [line for line, row in zip(lines, cells, strict=True) if not row]}


def test_each_topic_has_its_counts_and_a_dash_where_nobody_listens() -> None:
    told = shown(RESULT)
    assert told["/scan"] == ["12,345", "12,340", "5"]
    assert told["/tf"] == ["7", "-", "-"]
    assert told["/imu"] == ["9", "9", "0"]


def test_metrics_stand_beside_the_truth() -> None:
    told = shown(RESULT)
    assert told["distance"] == ["3.4 m", "3.46 m"]
    assert told["collisions"] == ["6 scans", "2 contacts, 0.25 s"]
    assert told["clearance"] == ["1.25 m", ""]
    assert told["velocity"] == ["0.31 m/s", ""]
    assert told["slip of moving wheels"] == ["", "0.13"]
    assert told["on rocks"] == ["", "5 contacts, 1.50 s"]
    assert told["scraping the ground"] == ["", "7 times, 0.75 s"]
    assert told["largest tilt"] == ["", "81 deg, tipped over"]


def test_speed_messages_and_log_are_told_below() -> None:
    lines = shown(RESULT)[""]
    assert "/controller_server: 63% of the run waited for it" in lines
    assert "12.50 simulated seconds in 2.50 s: 5.0x real time, 12,361 messages, 5 lost" in lines
    assert "12 rows in logs/a.csv" in lines


def test_a_run_without_a_row_or_a_log_shows_dashes() -> None:
    told = shown(RunResult(run=Run(), mode="direct"))
    assert [told[name][0] for name in ("distance", "collisions", "clearance", "velocity")] == ["-"] * 4
    assert told["largest tilt"] == ["", "0 deg"]
    assert not any("rows in" in line for line in told[""])


@pytest.mark.parametrize("terminal", [True, False])
def test_progress_is_shown_on_a_terminal_only(terminal: bool) -> None:
    out = io.StringIO()
    console = Console(file=out, width=120, force_terminal=terminal)
    with RunProgress(console, "leo on flat", 20.0) as bar:
        truth, topics = Truth(time_ns=5_000_000_000, path_length=1.23), {"/scan": TopicCount(4567)}
        run = Run.of(duration=20.0)
        bar.show(RunResult(run=run, mode="", truth=truth, wall_s=2.0, topics=topics))
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", out.getvalue())
    if terminal:
        assert "leo on flat" in text
        assert "5.0 / 20.0 s 2.5x real time 1.2 m 4,567 messages" in text
    else:
        assert text.strip() == ""


@pytest.mark.parametrize("is_terminal", [True, False])
def test_a_bar_counts_on_a_terminal_and_is_silent_elsewhere(*, is_terminal: bool) -> None:
    shown = io.StringIO()
    console = Console(file=shown, force_terminal=is_terminal, width=80)
    with counted(console, "drawing") as show:
        show(3, 7)
    assert ("drawing" in shown.getvalue() and "3/7" in shown.getvalue()) is is_terminal
    assert bool(shown.getvalue()) is is_terminal
