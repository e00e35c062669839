"""What a sweep shows on the terminal, and the files it leaves behind: same sweep, same bytes."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Column, Table

from harness.base.files import write_whole
from harness.base.version import __version__
from harness.tune.episodes.plan import Part, Planned
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.page.page import render
from harness.tune.parameter_file import parameter_file
from harness.tune.scoring.choose import Candidate, Verdict
from harness.tune.scoring.study import RobotStudy, conclusions
from rover_metrics.log.files import json_safe

SCORES, REPORT = "scores.json", "report.html"
DIGITS = 6  # of a score


def print_studies(console: Console, studies: Sequence[RobotStudy]) -> None:
    """For each robot a table of its thresholds and what follows from it."""
    for study in studies:
        console.print()
        console.print(_table(study))
        console.print(study.driven.text(), highlight=False)
        for conclusion in conclusions(study):
            console.print(f"- {conclusion}", highlight=False)


def _table(study: RobotStudy) -> Table:
    title = f"{study.name}: value and score, on seeds that no value was chosen on"
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
        tuned = "stays" if verdict.value is None else _scored(verdict, verdict.tuned)
        table.add_row(verdict.name, verdict.measure, _scored(verdict, verdict.default), tuned)
    return table


def _scored(verdict: Verdict, candidate: Candidate | None) -> str:
    if candidate is None:
        return "-"
    score = candidate.scores[Part.TEST][verdict.measure].text(verdict.digits).replace(" (", "\n(")
    return f"{verdict.written(candidate)}: {score}"


def write_results(
    folder: Path,
    studies: Sequence[RobotStudy],
    records: Mapping[Planned, EpisodeRecord],
    command: str,
) -> Iterator[Path]:
    """Writes the files, each there whole or not at all, and yields the path of each."""
    texts = {f"{study.name}.yaml": parameter_file(study, command) for study in studies}
    texts |= {SCORES: _scores(studies, command), REPORT: render(studies, records, command)}
    for name, text in texts.items():
        write_whole(folder / name, text)
        yield folder / name


def _scores(studies: Sequence[RobotStudy], command: str) -> str:
    """The text of scores.json; what is undefined is null."""
    robots = {
        study.name: json_safe(asdict(study), DIGITS) | {"conclusions": list(conclusions(study))}
        for study in studies
    }
    content = {"command": command, "version": __version__, "robots": robots}
    return json.dumps(content, indent=2, allow_nan=False) + "\n"
