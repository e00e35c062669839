"""What a sweep shows on the terminal: a progress bar, then a table and the conclusions."""

from collections.abc import Sequence
from typing import Self

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from harness.tuning.episodes.plan import Part
from harness.tuning.scoring.notes import conclusions
from harness.tuning.scoring.result import Candidate
from harness.tuning.scoring.study import RobotStudy


class SweepProgress:
    """A bar over episodes; silent where the output is no terminal.

    Args:
        console: Where.
        total: Number of episodes.
        duration: Of each [s].
    """

    def __init__(self, console: Console, total: int, duration: float) -> None:
        self._bar = Progress(
            TextColumn("[bold]driving {task.fields[duration]:g} s episodes"),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=console,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("", total=total, duration=duration)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def show(self, done: int) -> None:
        """Moves the bar."""
        self._bar.update(self._task, completed=done)


def print_studies(console: Console, studies: Sequence[RobotStudy]) -> None:
    """For each robot a table of its thresholds and what follows from it."""
    for study in studies:
        console.print()
        console.print(_table(study))
        console.print(study.driven.text(), highlight=False)
        for conclusion in conclusions(study):
            console.print(f"- {conclusion}", highlight=False)


def _table(study: RobotStudy) -> Table:
    title = f"{study.robot}: value and score, on seeds that no value was chosen on"
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD)
    for column in ("threshold", "measure", "default", "tuned"):
        table.add_column(column, no_wrap=column == "threshold")
    for verdict in study.verdicts:
        tuned = "stays" if verdict.value is None else _scored(verdict.tuned, verdict.measure)
        table.add_row(verdict.name, verdict.measure, _scored(verdict.default, verdict.measure), tuned)
    return table


def _scored(candidate: Candidate | None, measure: str) -> str:
    if candidate is None:
        return "-"
    score = candidate.scores[Part.TEST][measure].text().replace(" (", "\n(")
    return f"{candidate.value:g}: {score}"
