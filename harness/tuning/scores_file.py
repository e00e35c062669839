"""All scores of a sweep as JSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict

from harness import __version__
from harness.tuning.scoring.notes import conclusions
from harness.tuning.scoring.study import RobotStudy
from rover_metrics.log.files import json_safe

DIGITS = 6


def scores_file(studies: Sequence[RobotStudy], command: str) -> str:
    """The text of scores.json; what is undefined is null."""
    robots = {
        study.robot: json_safe(asdict(study), DIGITS) | {"conclusions": list(conclusions(study))}
        for study in studies
    }
    content = {"command": command, "version": __version__, "robots": robots}
    return json.dumps(content, indent=2, allow_nan=False) + "\n"
