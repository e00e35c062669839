"""The JSON beside a log that tells whether its session has ended: outcome is null until it has.

harness.run replaces it by its own, richer one, which has the same key.
"""

import json
from collections.abc import Callable, Mapping
from datetime import datetime
from enum import Enum
from pathlib import Path
from typing import Any

from rover_metrics.core.thresholds import THRESHOLD_INFO, Thresholds
from rover_metrics.errors import LogError, ParameterError
from rover_metrics.log.documents import DocumentError, read_json
from rover_metrics.log.files import write_whole

Outcome = Mapping[str, str | None]

COMPLETE: Outcome = {"status": "complete", "reason": None}


class SessionRecord:
    """The record of one running session; what cannot be written is reported and costs nothing else.

    It has failed if `failure` says why.

    Args:
        node: Full name of the node.
        now: Returns the wall time.
        tell: Takes lines for the user.
    """

    def __init__(self, node: str, now: Callable[[], datetime], tell: Callable[[str], None]) -> None:
        self._node, self._now, self._tell = node, now, tell
        self._started, self._is_over = now(), False
        self.failure: str | None = None

    def begin(self, log: Path) -> None:
        """Writes that the session runs."""
        self._write(log, None, {"ended": None})

    def end(self, log: Path, lost_rows: int, details: Mapping[str, Any]) -> None:
        """Writes that the session is over; does nothing from the second call on.

        Args:
            log: The CSV file that the record stands beside.
            lost_rows: How many could not be written.
            details: What else the record tells, by its keys.
        """
        if self._is_over:
            return
        self._is_over = True
        failure = self.failure or (f"{lost_rows} rows could not be written" if lost_rows else None)
        outcome = COMPLETE if failure is None else failed(failure)
        ended = self._now().astimezone().isoformat()
        self._write(log, outcome, {"ended": ended, "lost_rows": lost_rows, **details})

    def _write(self, log: Path, outcome: Outcome | None, details: Mapping[str, Any]) -> None:
        started = self._started.astimezone().isoformat()
        try:
            write_record(log, outcome, {"node": self._node, "started": started, **details})
        except LogError as error:
            self._tell(str(error))


class SessionEnd(Enum):
    """How the session that wrote a log has ended, as its record tells."""

    MARKED = "it has ended, and said so"
    UNMARKED = "it was killed, or is still running"
    UNKNOWN = "there is no record, as with every log of RoboTerrain's own node"


def failed(reason: str) -> Outcome:
    """Returns the outcome of a session that ended badly."""
    return {"status": "failed", "reason": reason}


def write_record(log: Path, outcome: Outcome | None, details: Mapping[str, Any]) -> None:
    """Writes the record of a log, or raises a LogError; it is there whole or not at all.

    Args:
        log: The log's file.
        outcome: How the session has ended: its status and the reason; None while it runs.
        details: What else shall stand there, as JSON values.
    """
    path = log.with_suffix(".json")
    text = json.dumps({"log": str(log), "outcome": outcome, **details}, indent=2) + "\n"
    try:
        write_whole(path, text)
    except OSError as error:
        raise LogError(f"cannot write the session's record to {path}: {error.strerror}") from error


def session_end(log: str | Path) -> SessionEnd:
    """Returns how the session of a log has ended."""
    record = _read(log)
    if "outcome" not in record:
        return SessionEnd.UNKNOWN
    return SessionEnd.UNMARKED if record["outcome"] is None else SessionEnd.MARKED


def session_thresholds(log: str | Path) -> Thresholds | None:
    """Returns the thresholds at the end of a log's session; None if its record does not tell."""
    kept = _read(log).get("thresholds")
    if not isinstance(kept, dict):
        return None
    try:
        return Thresholds(**{name: float(kept[name]) for name in THRESHOLD_INFO if name in kept})
    except (ArithmeticError, ParameterError, TypeError, ValueError):
        return None


def session_arguments(log: str | Path) -> dict[str, Any]:
    """Returns the arguments of the harness's run that a log is of; none if its record does not tell."""
    arguments = _read(log).get("arguments")
    return arguments if isinstance(arguments, dict) else {}


def _read(log: str | Path) -> dict[str, Any]:
    path = Path(log).with_suffix(".json")
    try:
        record = read_json(path) if path.is_file() else {}  # a pipe would wait for its writer
    except DocumentError:
        return {}
    return record if isinstance(record, dict) else {}
