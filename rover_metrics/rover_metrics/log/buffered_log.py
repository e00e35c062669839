"""A log that outlives a failing disk: rows wait in memory, in order, until the file takes them."""

from collections import deque
from collections.abc import Callable, Sequence
from datetime import datetime
from pathlib import Path

from rover_metrics.core.columns import COLUMNS, Row
from rover_metrics.errors import LogError, is_worth_a_line
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.log.social_log import SocialRow

CAPACITY = 3600  # rows: an hour, about 2 MB


class BufferedLog(CsvLog):
    """A CsvLog in which rows that the file refuses wait.

    Every row is tried again with the next one. Above the capacity the oldest row is dropped and
    counted. A refusal is reported when it begins, when its reason changes and when it is over.

    Args:
        directory: Folder for the file; created if it does not exist.
        started: When the session started.
        tell: Takes lines for the user.
        capacity: Most rows that wait.
        fsync: Whether a row is on the disk itself before `write` returns.
        columns: The header.
    """

    def __init__(
        self,
        directory: str | Path,
        started: datetime,
        tell: Callable[[str], None],
        capacity: int = CAPACITY,
        *,
        fsync: bool = False,
        columns: Sequence[str] = COLUMNS,
    ) -> None:
        self._tell, self._capacity = tell, capacity
        self._waiting: deque[Row | SocialRow] = deque()
        self._refusal: str | None = None
        self.dropped = 0
        super().__init__(directory, started, fsync=fsync, columns=columns)

    @property
    def waiting(self) -> int:
        """Rows that are not in the file yet."""
        return len(self._waiting)

    def write(self, row: Row | SocialRow) -> None:
        """Appends a row, after those that wait; raises a LogError only if the log is closed."""
        if self._file.closed:
            raise LogError(f"cannot write a row to {self.path}: the log is closed")
        self._waiting.append(row)
        self._write_waiting()
        if self.waiting > self._capacity:
            self._drop(1)

    def close(self) -> None:
        """Tries the waiting rows a last time and closes the file, telling what fails; twice is fine."""
        if not self._file.closed:
            self._write_waiting()
            self._drop(self.waiting)
            try:
                super().close()
            except LogError as error:
                self._tell(str(error))

    def _write_waiting(self) -> None:
        late = self.waiting
        while self._waiting:
            try:
                super().write(self._waiting[0])
            except LogError as error:
                if str(error) != self._refusal:
                    self._refusal = str(error)
                    self._tell(f"{error}. Up to {self._capacity} rows wait in memory until it is mended")
                return
            self._waiting.popleft()
        if self._refusal is not None:
            self._refusal = None
            self._tell(f"writing to {self.path} again: {late} rows caught up, {self.dropped} lost")

    def _drop(self, rows: int) -> None:
        for _ in range(rows):
            self._waiting.popleft()
        before, self.dropped = self.dropped, self.dropped + rows
        if is_worth_a_line(before, self.dropped):
            self._tell(f"{self.dropped} rows are lost so far: {self._refusal}")
