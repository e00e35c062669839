"""The figures that a run shows on the terminal."""

import io
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from harness.cli.console import Heartbeat, counted, driving, print_summary
from harness.episode.result import CommandCount, RunResult, TopicCount
from harness.samples import Truth
from harness.spec.run import Run
from tests.harness.page.run.made import TRUTH
from tests.support.snapshots import check_snapshot

TIPPED = replace(
    TRUTH, time_ns=12_500_000_000, path_length=3.456, largest_tilt=math.radians(81.4), tipped_over=True
)
RESULT = RunResult(
    run=Run(),
    mode="direct",
    truth=TIPPED,
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


def test_the_summary_of_a_run_is_as_somebody_has_checked() -> None:
    out = io.StringIO()
    console = Console(file=out, width=120)
    commands, refusal = CommandCount(taken=1200, older=1100, refused=3), "a command in the frame 'map'"
    print_summary(console, replace(RESULT, commands=commands, refusal=refusal))
    print_summary(console, RunResult(run=Run(), mode="direct"))
    check_snapshot("console.txt", out.getvalue())


@pytest.mark.parametrize("terminal", [True, False])
def test_progress_is_shown_on_a_terminal_only(terminal: bool) -> None:
    out = io.StringIO()
    console = Console(file=out, width=120, force_terminal=terminal)
    with driving(console, "leo on flat", 20.0) as show_run:
        truth, topics = Truth(time_ns=5_000_000_000, path_length=1.23), {"/scan": TopicCount(4567)}
        run = Run.of(duration=20.0)
        show_run(RunResult(run=run, mode="", truth=truth, wall_s=2.0, topics=topics))
    with counted(console, "drawing") as show:
        show(3, 7)
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", out.getvalue())
    if terminal:
        assert "leo on flat" in text
        assert "5.0 / 20.0 s 2.5x real time 1.2 m 4,567 messages" in text
        assert "drawing" in text
        assert "3/7" in text
    else:
        assert text.strip() == ""


def test_in_a_pipe_steady_work_is_told_to_last_as_long_as_it_will(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now, whole = 50.0, 90.0  # [s] of wall time, of which the work takes so many
    monkeypatch.setattr("harness.cli.console.time.monotonic", lambda: now)
    heartbeat = Heartbeat(Console(file=io.StringIO()), "sweep")
    for passed in range(0, 100, 3):
        now = 50.0 + passed
        heartbeat.tell(4.0 * passed, 4.0 * whole, "")
    told = [[*map(float, re.findall(r"[\d.]+", line))] for line in capsys.readouterr().err.splitlines()]
    assert len(told) == 7
    assert [done / 4.0 + left for done, _, left in told] == pytest.approx([whole] * 7, abs=0.6)
