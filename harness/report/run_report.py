"""The report of a run as its command sees it: asked for or not, watching, written at the end."""

from pathlib import Path

from harness.episode.batch import Batch
from harness.episode.result import RunResult
from harness.errors import HarnessError
from harness.files import check_target, whole_file
from harness.report.recorder import RunRecorder


class RunReport:
    """Does nothing at all without a path.

    Args:
        path: Where the page goes; None if nobody asked for one.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._recorder = RunRecorder()

    def prepare(self) -> None:
        """Finds out before the run whether the page can be written.

        Raises:
            UsageError: It cannot; the message names the mend.
        """
        if self._path is not None:
            check_target("--report", self._path)

    def take(self, batch: Batch) -> None:
        """Takes the next batch of the run."""
        if self._path is not None:
            self._recorder.take(batch)

    def write(self, result: RunResult) -> Path | None:
        """Writes the page, however the run ended; it is there whole or not at all.

        Raises:
            HarnessError: It cannot be written.
        """
        if self._path is None:
            return None
        # Loads MuJoCo and plotly: not before the run, whose publishing process needs neither.
        from harness.report.content import render  # noqa: PLC0415

        page = render(result, self._recorder)
        try:
            with whole_file(self._path) as part:
                part.write_text(page, encoding="utf-8", newline="\n")
        except OSError as error:
            message = f"cannot write the report to {self._path}: {error.strerror}"
            raise HarnessError(message) from error
        return self._path
