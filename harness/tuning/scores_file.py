"""All scores of a sweep as JSON."""

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from harness import __version__
from harness.tuning.scoring.notes import conclusions
from harness.tuning.scoring.study import RobotStudy

DIGITS = 6


def scores_file(studies: Sequence[RobotStudy], command: str) -> str:
    """The text of scores.json; what is undefined is null."""
    robots = {
        study.robot: _plain(asdict(study)) | {"conclusions": list(conclusions(study))}
        for study in studies
    }
    content = {"command": command, "version": __version__, "robots": robots}
    return json.dumps(content, indent=2, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:  # noqa: ANN401 - any value of a study
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return round(value, DIGITS) if math.isfinite(value) else None
    return value
