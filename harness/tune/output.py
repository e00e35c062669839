"""What a sweep shows on the terminal, and the files it leaves behind: same sweep, same bytes."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from io import StringIO
from pathlib import Path

from rich.console import Console
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from harness.base.files import write_whole
from harness.base.version import __version__
from harness.episode.metrics_feed import extended_settings
from harness.robots import find_rover
from harness.tune.episodes.plan import Part, Planned
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.page.page import render
from harness.tune.scoring.choose import Candidate, Verdict
from harness.tune.scoring.study import RobotStudy, conclusions
from rover_metrics.extended.settings import Settings
from rover_metrics.log.files import json_safe
from rover_metrics.sheet.render import terminal
from rover_metrics.sheet.sheet import Sheet

SCORES, REPORT = "scores.json", "report.html"
DIGITS = 6  # of a score
INDENT = 4  # of a parameter in the file
FOOTPRINT_UNITS = {
    "footprint": "corners x, y [m]; read with extended_columns:=true",
    "lidar_pose": "x, y [m], yaw [rad]",
}


def print_studies(console: Console, studies: Sequence[RobotStudy]) -> None:
    """Prints a table of each robot's thresholds and what follows from it."""
    for study in studies:
        console.print(*terminal([sheet_of(study)], console.width), sep="\n")
        console.print(study.driven.text(), highlight=False)
        for conclusion in conclusions(study):
            console.print(f"- {conclusion}", highlight=False)


def sheet_of(study: RobotStudy) -> Sheet:
    """Returns a robot's thresholds with their scores."""
    rows = (
        (
            verdict.name,
            verdict.measure,
            _scored(verdict, verdict.default),
            "stays" if verdict.value is None else _scored(verdict, verdict.tuned),
        )
        for verdict in study.verdicts
    )
    title = f"{study.name}: value and score, on seeds that no value was chosen on"
    return Sheet(("threshold", "measure", "default", "tuned"), tuple(rows), title)


def _scored(verdict: Verdict, candidate: Candidate | None) -> str:
    if candidate is None:
        return "-"
    score = candidate.scores[Part.TEST][verdict.measure].text(verdict.digits).replace(" (", "\n(")
    return f"{verdict.written(candidate)}: {score}"


def write_results(
    folder: Path, studies: Sequence[RobotStudy], records: Mapping[Planned, EpisodeRecord], command: str
) -> Iterator[Path]:
    """Writes the files, each there whole or not at all, and yields the path of each.

    Args:
        folder: Gets them.
        studies: One per robot.
        records: All episodes of the sweep.
        command: Words that make these files again, for the files themselves.
    """
    files = {study.name: parameter_file(study, command) for study in studies}
    page = render(studies, records, command, files)
    texts = {f"{name}.yaml": text for name, text in files.items()}
    robots = {
        study.name: json_safe(asdict(study), DIGITS) | {"conclusions": list(conclusions(study))}
        for study in studies
    }
    scores = {"command": command, "version": __version__, "robots": robots}
    texts |= {SCORES: json.dumps(scores, indent=2, allow_nan=False) + "\n", REPORT: page}
    for name, text in texts.items():
        write_whole(folder / name, text)
        yield folder / name


def parameter_file(study: RobotStudy, command: str) -> str:
    """Returns the text of ROBOT.yaml.

    A threshold that the data do not support is not in it; a comment says why. `/**` holds for the node
    in every namespace; `command` is what makes this file.
    """
    parameters, left_out = CommentedMap(), list[str]()
    for verdict in study.verdicts:
        if verdict.value is None or verdict.tuned is None:
            why = verdict.lack or "no value is proven to be better on unseen seeds"
            left_out.append(f"{verdict.name} stays at {verdict.written(verdict.default)}: {why}")
        else:
            parameters[verdict.name] = verdict.value
            _comment(parameters, verdict, verdict.tuned)
    _add_footprint(parameters, study)
    header = [
        f"{study.name}: {find_rover(study.robot).summary}",
        f"Made by: {command} (rover-harness {__version__})",
        "Use: metrics_node --ros-args --params-file THIS_FILE",
        *left_out,
    ]
    yaml, text = YAML(), StringIO()
    yaml.width = 1000  # no line is folded
    yaml.dump({"/**": {"ros__parameters": parameters}}, text)
    return "".join(f"# {line}\n" for line in header) + text.getvalue()


def _comment(parameters: CommentedMap, verdict: Verdict, tuned: Candidate) -> None:
    """Puts the scores above a parameter and its unit behind it."""
    score = tuned.scores[Part.TEST][verdict.measure]
    default = verdict.default.scores[Part.TEST][verdict.measure]
    scores = (
        f"{verdict.measure} on unseen seeds {score.text(verdict.digits)}; with the default, "
        f"{verdict.written(verdict.default)}: {default.text(verdict.digits)}"
    )
    lines = "\n".join(filter(None, (scores, verdict.note)))
    parameters.yaml_set_comment_before_after_key(verdict.name, lines, indent=INDENT)
    if verdict.unit:
        parameters.yaml_add_eol_comment(verdict.unit, verdict.name)


def _add_footprint(parameters: CommentedMap, study: RobotStudy) -> None:
    """What the columns of the footprint need: of the model, not tuned."""
    settings = Settings(extended=extended_settings(find_rover(study.robot)))
    for name, unit in FOOTPRINT_UNITS.items():
        parameters[name] = CommentedSeq(round(value, 5) for value in settings.parameters[name])
        parameters[name].fa.set_flow_style()
        parameters.yaml_add_eol_comment(unit, name)
