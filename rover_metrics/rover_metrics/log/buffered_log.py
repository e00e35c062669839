"""A log that outlives a failing disk: rows wait in memory, in order, until the file takes them."""

from collections import deque
from collections.abc import Callable
from pathlib import Path

from rover_metrics.core.row import Row
from rover_metrics.errors import LogError, is_worth_a_line
from rover_metrics.log.csv_log import CsvLog

CAPACITY = 3600  # rows: an hour, about 2 MB


class BufferedLog:
    """Writes rows to a CsvLog; what that refuses waits, at most `capacity` rows.

    Every row is tried again with the next one. Above the capacity the oldest row is dropped and
    counted. A refusal is told when it begins, when its reason changes and when it is over.

    Args:
        log: Where the rows go; closed with this one.
        tell: Is given a line for the user.
        capacity: How many rows may wait.

    Attributes:
        dropped: Rows that were given up.
    """

    def __init__(self, log: CsvLog, tell: Callable[[str], None], capacity: int = CAPACITY) -> None:
        self._log, self._tell, self._capacity = log, tell, capacity
        self._waiting: deque[Row] = deque()
        self._refusal: str | None = None
        self._closed = False
        self.dropped = 0

    @property
    def path(self) -> Path:
        """The file."""
        return self._log.path

    @property
    def rows(self) -> int:
        """Rows in the file."""
        return self._log.rows

    @property
    def waiting(self) -> int:
        """Rows that are not in the file yet."""
        return len(self._waiting)

    @property
    def fsync(self) -> bool:
        """Whether a row is on the disk itself before `write` returns."""
        return self._log.fsync

    @fsync.setter
    def fsync(self, value: bool) -> None:
        self._log.fsync = value

    def write(self, row: Row) -> None:
        """Appends a row, after those that wait.

        Raises:
            LogError: The log is closed.
        """
        if self._closed:
            raise LogError(f"cannot write a row to {self.path}: the log is closed")
        self._waiting.append(row)
        self._write_waiting()
        if len(self._waiting) > self._capacity:
            self._waiting.popleft()
            self._drop(1)

    def close(self) -> None:
        """Try the waiting rows a last time and close the file; closing twice is fine."""
        if self._closed:
            return
        self._closed = True
        self._write_waiting()
        if self._waiting:
            self._drop(len(self._waiting))
            self._waiting.clear()
        self._log.close()

    def _write_waiting(self) -> None:
        late = len(self._waiting)
        while self._waiting:
            try:
                self._log.write(self._waiting[0])
            except LogError as error:
                self._refused(str(error))
                return
            self._waiting.popleft()
        if self._refusal is not None:
            self._refusal = None
            self._tell(f"writing to {self.path} again: {late} rows caught up, {self.dropped} lost")

    def _refused(self, refusal: str) -> None:
        if refusal != self._refusal:
            self._refusal = refusal
            self._tell(f"{refusal}. Up to {self._capacity} rows wait in memory until it is mended")

    def _drop(self, rows: int) -> None:
        before, self.dropped = self.dropped, self.dropped + rows
        if is_worth_a_line(before, self.dropped):
            self._tell(f"{self.dropped} rows are lost so far: {self._refusal}")
