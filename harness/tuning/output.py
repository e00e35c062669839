"""The files of a finished sweep: a parameter file per robot, scores, report. Same sweep, same bytes."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from harness.errors import HarnessError
from harness.files import whole_file
from harness.tuning.episodes.plan import Planned
from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.page.page import render
from harness.tuning.parameter_file import parameter_file
from harness.tuning.scores_file import scores_file
from harness.tuning.scoring.study import RobotStudy

SCORES, REPORT = "scores.json", "report.html"


def write_results(
    folder: Path,
    studies: Sequence[RobotStudy],
    records: Mapping[Planned, EpisodeRecord],
    command: str,
) -> Iterator[Path]:
    """Writes the files, each there whole or not at all, and tells of each.

    Args:
        folder: Of the sweep.
        studies: One per robot.
        records: All episodes.
        command: What makes these files.

    Raises:
        HarnessError: One cannot be written.
    """
    for study in studies:
        yield _write(folder / f"{study.robot}.yaml", parameter_file(study, command))
    yield _write(folder / SCORES, scores_file(studies, command))
    yield _write(folder / REPORT, render(studies, records, command))


def _write(path: Path, text: str) -> Path:
    try:
        with whole_file(path) as part:
            part.write_text(text, encoding="utf-8")
    except OSError as error:
        message = f"cannot write {path}: {error.strerror}"
        raise HarnessError(message) from error
    return path
