"""Reads a metrics log as it is on the disk: of a session that ended, was killed or still runs."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path

from rover_metrics.errors import LogError
from rover_metrics.session_record import SessionEnd, session_end


@dataclass(frozen=True)
class LoggedRows:
    """The whole rows of a log.

    Attributes:
        columns: The header.
        rows: The cells of each row as text, one per column.
        findings: What was skipped or is odd, a line each, for the user to see.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    findings: tuple[str, ...] = ()


def read_rows(path: str | Path) -> LoggedRows:
    """Read a log; a line that is not whole is skipped with a finding.

    A line counts once its end is there: a writer that died or a disk that was full leaves a last line
    without one, and a number cut short still looks like a number.

    Raises:
        LogError: There is no such file, or no header in it.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise LogError(f"cannot read {path}: {error.strerror}") from error
    whole, end, torn = data.rpartition(b"\n")
    lines = csv.reader(io.StringIO((whole + end).decode("utf-8", "replace"), newline=""))
    columns = tuple(next(lines, ()))
    if not columns:
        raise LogError(f"{path} has no header; a metrics log starts with the names of its columns")
    rows: list[tuple[str, ...]] = []
    findings: list[str] = []
    for cells in lines:
        if len(cells) == len(columns):
            rows.append(tuple(cells))
        elif cells:
            findings.append(
                f"line {lines.line_num} has {len(cells)} cells instead of {len(columns)}; skipped"
            )
    if torn:
        findings.append(
            f"line {lines.line_num + 1} is torn (the disk was full, or power or writer failed); skipped"
        )
    if session_end(path) is SessionEnd.UNMARKED:
        findings.append(f"the session has no end mark: {SessionEnd.UNMARKED.value}")
    return LoggedRows(columns, tuple(rows), tuple(findings))
