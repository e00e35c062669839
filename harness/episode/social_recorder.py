"""The social log of a run with people: every row is in the file before the next second."""

from datetime import datetime
from pathlib import Path

from harness.base.errors import RunFailed, UsageError
from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.samples import ActorPoses, Pose, Quaternion
from rover_metrics.core.goals import GoalAccount
from rover_metrics.errors import LogError
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.log.social_log import SocialRows, social_columns

STEM, FOLDER = "social_log", "social"


class SocialRecorder:
    """Watches the batches of one run.

    Args:
        actors: Names of the people, in the order of their poses.
        file: The log, which must not exist; None for a new one in `log_dir`/social.
        log_dir: Folder of the metrics log.
        overwrite: Whether `file` may exist: then it is replaced with the first row.

    Attributes:
        path: The log; None before the first row's second has begun.

    Raises:
        UsageError: The file exists, or its name does not end in .csv.
    """

    def __init__(
        self, actors: tuple[str, ...], file: Path | None, log_dir: Path, *, overwrite: bool = False
    ) -> None:
        if file is not None and file.suffix != ".csv":
            raise UsageError(f"--social-log {file} does not end in .csv; name a file that does")
        if file is not None and file.exists() and not file.is_file():
            raise UsageError(f"--social-log {file} is no file; name another")
        if file is not None and file.exists() and not overwrite:
            mend = "not overwriting; name another file or --overwrite"
            raise UsageError(f"--social-log {file} exists already, {mend}")
        self._actors, self._file, self._log_dir = actors, file, log_dir
        self._rows, self.goals = SocialRows(), GoalAccount()
        self._log: CsvLog | None = None
        self._orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)
        self._began_s = 0.0

    @property
    def path(self) -> Path | None:
        """Where the rows are."""
        return None if self._log is None else self._log.path

    def take(self, batch: Batch) -> None:
        """Takes the next batch; RunFailed where a row cannot be written."""
        for goal in batch.goals:
            self.goals.begin((goal.x, goal.y), self._began_s)
        self._began_s = batch.truth.time_ns / NANOSECONDS
        for tick in batch.ticks:
            pose, people = tick.of(Pose), tick.of(ActorPoses)
            if pose is not None:
                self._orientation = pose.orientation
            if tick.stamp_ns % NANOSECONDS == 0 and pose is not None and people is not None:
                self._write(tick.stamp_ns / NANOSECONDS, pose, people)
        x, y, _ = batch.truth.position
        self.goals.observe(self._began_s, (x, y), self._orientation)

    def close(self) -> None:
        """Closes the log."""
        if self._log is not None:
            self._log.close()

    def _write(self, time_s: float, rover: Pose, people: ActorPoses) -> None:
        places = {name: (x, y) for name, (x, y, _) in zip(self._actors, people.position, strict=True)}
        row = self._rows.next(time_s, rover.position[:2], places, self.goals.reached)
        try:
            if self._log is None:
                self._log = self._opened()
            self._log.write(row)
        except LogError as error:
            raise RunFailed(f"the social log: {error}") from error

    def _opened(self) -> CsvLog:
        folder = self._log_dir / FOLDER if self._file is None else self._file.parent
        stem = STEM if self._file is None else self._file.stem
        started = datetime.now() if self._file is None else None
        if self._file is not None:
            self._file.unlink(missing_ok=True)
        return CsvLog(folder, started, stem=stem, columns=social_columns(self._actors))
