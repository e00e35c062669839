"""What a sweep shows on the terminal: a progress bar, then a table and the conclusions."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Column, Table

from harness.tuning.episodes.plan import Part
from harness.tuning.scoring.notes import conclusions
from harness.tuning.scoring.result import Candidate
from harness.tuning.scoring.study import RobotStudy


@contextmanager
def sweep_progress(console: Console, total: int, duration: float) -> Iterator[Callable[[int], None]]:
    """Yields what moves a bar over episodes, told how many are done; silent where there is no terminal.

    Args:
        console: Where.
        total: Number of episodes.
        duration: Of each [s].
    """
    with Progress(
        TextColumn(f"[bold]driving {duration:g} s episodes"),
        BarColumn(bar_width=None),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    ) as bar:
        task = bar.add_task("", total=total)
        yield lambda done: bar.update(task, completed=done)


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
    table = Table(
        Column("threshold", no_wrap=True),
        "measure",
        "default",
        "tuned",
        title=title,
        title_justify="left",
        box=SIMPLE_HEAD,
    )
    for verdict in study.verdicts:
        tuned = "stays" if verdict.value is None else _scored(verdict.tuned, verdict.measure)
        table.add_row(verdict.name, verdict.measure, _scored(verdict.default, verdict.measure), tuned)
    return table


def _scored(candidate: Candidate | None, measure: str) -> str:
    if candidate is None:
        return "-"
    score = candidate.scores[Part.TEST][measure].text().replace(" (", "\n(")
    return f"{candidate.value:g}: {score}"
