"""What the page shows, gathered: the names of the template's variables are the keys here."""

from collections.abc import Mapping, Sequence
from typing import Any

from harness import __version__
from harness.page.figure import Plot
from harness.tuning.episodes.plan import Planned
from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.page import tables
from harness.tuning.page.episodes import subject
from harness.tuning.page.method import SENTENCES
from harness.tuning.page.sections import row, sections
from harness.tuning.parameter_file import parameter_file
from harness.tuning.scoring.notes import conclusions
from harness.tuning.scoring.study import RobotStudy


def content(
    studies: Sequence[RobotStudy], records: Mapping[Planned, EpisodeRecord], command: str
) -> dict[str, Any]:
    """Everything that the template needs to know."""
    subjects = [subject(study, records) for study in studies]
    parts = list(sections(subjects))
    plots = [
        cell.content
        for section in parts
        for line in section.rows
        for cell in line.cells
        if isinstance(cell.content, Plot)
    ]
    return {
        "robots": [study.robot for study in studies],
        "command": command,
        "version": __version__,
        "verdicts": [
            (study.robot, list(conclusions(study)), parameter_file(study, command)) for study in studies
        ],
        "thresholds": [(study.robot, tables.thresholds(study)) for study in studies],
        "sections": parts,
        "figures": {plot.name: plot.figure for plot in plots},
        "driven": row("", "", subjects, lambda one: tables.driven(one.study)),
        "method": SENTENCES,
    }
