"""The files of a finished sweep: a parameter file per robot, scores, report. Same sweep, same bytes."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from harness import __version__
from harness.errors import HarnessError
from harness.files import whole_file
from harness.tuning.episodes.plan import Planned
from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.page.page import render
from harness.tuning.parameter_file import parameter_file
from harness.tuning.scoring.notes import conclusions
from harness.tuning.scoring.study import RobotStudy
from rover_metrics.log.files import json_safe

SCORES, REPORT = "scores.json", "report.html"
DIGITS = 6  # of a score


def write_results(
    folder: Path,
    studies: Sequence[RobotStudy],
    records: Mapping[Planned, EpisodeRecord],
    command: str,
) -> Iterator[Path]:
    """Writes the files, each there whole or not at all, and yields the path of each.

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


def scores_file(studies: Sequence[RobotStudy], command: str) -> str:
    """Returns the text of scores.json; what is undefined is null."""
    robots = {
        study.robot: json_safe(asdict(study), DIGITS) | {"conclusions": list(conclusions(study))}
        for study in studies
    }
    content = {"command": command, "version": __version__, "robots": robots}
    return json.dumps(content, indent=2, allow_nan=False) + "\n"


def _write(path: Path, text: str) -> Path:
    try:
        with whole_file(path) as part:
            part.write_text(text, encoding="utf-8")
    except OSError as error:
        message = f"cannot write {path}: {error.strerror}"
        raise HarnessError(message) from error
    return path
