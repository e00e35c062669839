"""Resident memory of a run's processes, after its first simulated minute and at its end (Linux)."""

from collections.abc import Mapping
from pathlib import Path

MEGABYTE = 1e6
MINUTE = 60  # rows: one per simulated second

Sizes = dict[str, float]  # resident memory [bytes] by process


class Growth:
    """Looks at a run now and then.

    Args:
        logs: Folder of one of its metrics nodes.
        seconds: How long the run will be [simulated s].
        others: Process numbers of nodes elsewhere, by what to call them.

    Attributes:
        minute: Sizes at the first look after the first minute.
        end: Sizes at the last look.
    """

    def __init__(self, logs: Path, seconds: float, others: Mapping[str, int] | None = None) -> None:
        self._logs, self._seconds, self._others = logs, seconds, others or {}
        self.minute: Sizes = {}
        self.end: Sizes = {}

    def look(self, harness: int) -> None:
        """Takes down what the processes hold; `harness` is the number of the run's."""
        if MINUTE <= rows_in(self._logs) < self._seconds:
            self.end = _sizes(harness, self._others) or self.end
            self.minute = self.minute or self.end

    @property
    def grown(self) -> Sizes:
        """From the minute to the end, by process; empty if nobody looked in between."""
        return {process: self.end[process] - size for process, size in self.minute.items()}


def _sizes(harness: int, others: Mapping[str, int]) -> Sizes:
    """Memory of the harness and of others; empty if one is gone."""
    try:
        found = {name: resident(number) for name, number in {"harness": harness, **others}.items()}
    except OSError:
        return {}
    return found if all(found.values()) else {}


def resident(process: int) -> float:
    """Returns the resident memory [bytes]; 0 for a process that has ended."""
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return float(line.split()[1]) * 1024
    return 0.0


def rows_in(logs: Path) -> int:
    """Rows logged so far into a folder."""
    return sum(log.read_bytes().count(b"\n") - 1 for log in logs.glob("*.csv"))
