"""Tuned thresholds as a ROS 2 parameter file for metrics_node."""

from io import StringIO

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from harness.base.version import __version__
from harness.episode.metrics_feed import extended_settings
from harness.robots import find_rover
from harness.tune.episodes.plan import Part
from harness.tune.scoring.choose import Candidate, Verdict
from harness.tune.scoring.study import RobotStudy
from rover_metrics.extended.settings import Settings

INDENT = 4  # of a parameter in the file
FOOTPRINT_UNITS = {
    "footprint": "corners x, y [m]; read with extended_columns:=true",
    "lidar_pose": "x, y [m], yaw [rad]",
}


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
