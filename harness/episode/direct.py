"""Runs without ROS: with a log, the same CSV bytes; without, for whoever asks for the truth alone.

For machines without rclpy and for speed. What the MetricsNode's callbacks take from a message is taken
from the sample, in the same order: a tick's samples first, then the row if a second is full.
"""

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Self

from harness.base.errors import RunFailed, UsageError
from harness.base.interrupt import StopRequest
from harness.config import EpisodeConfig, RosOptions
from harness.drivers import sensed_by
from harness.episode.batch import Batch
from harness.episode.episode import Episode, fleet_of, together
from harness.episode.loop import Lane, Observer, Pacer, drive, drive_all, injector
from harness.episode.metrics_feed import DirectMetrics
from harness.episode.result import RoverRun, RunAccount, RunResult, Show, TopicCount, cells_of
from harness.faults.injector import FaultInjector
from harness.samples import Sample, Tick
from harness.sensors.lidar_spec import LidarSpec
from rover_metrics.errors import LogError
from rover_metrics.extended.settings import Settings
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.log.session_record import COMPLETE, Outcome, failed, write_record
from rover_metrics.session import MetricsSession

DEFAULT_SETTINGS = Settings()


def run_direct(
    config: EpisodeConfig,
    options: RosOptions,
    stop: StopRequest,
    show: Show | None = None,
    observers: Sequence[Observer] = (),
    settings: Settings = DEFAULT_SETTINGS,
) -> RunResult:
    """Runs an episode without ROS and returns what it came to, also when it failed underway.

    Args:
        config: What to run.
        options: Its `log_dir` and its `rate` count.
        stop: Ends the run early.
        show: Is told the result up to now after every batch.
        observers: See every batch once it has been taken.
        settings: Of the metrics.

    Raises:
        UsageError: The arguments are not valid or the log cannot be created.
    """
    only = RoverRun(config=config, log_dir=options.log_dir, observers=observers, settings=settings)
    (result,) = run_all_direct((only,), options, stop, show)
    return result


def run_all_direct(
    rovers: Sequence[RoverRun], options: RosOptions, stop: StopRequest, show: Show | None = None
) -> tuple[RunResult, ...]:
    """Runs rovers that share a world without ROS, as `run_direct` runs one; returns the result of each.

    Args:
        rovers: What to run.
        options: Its `rate` counts.
        stop: Ends the run early.
        show: Is told the first one's result up to now after every batch.

    Raises:
        UsageError: The arguments are not valid or a log cannot be created.
    """
    started = time.monotonic()
    episodes = fleet_of([rover.config for rover in rovers])
    with ExitStack() as at_end:
        logged, lanes = list[LoggedRun](), list[Lane]()
        for rover, episode in zip(rovers, episodes, strict=True):
            begun = RunResult(config=rover.config, mode="direct, no ROS", info=episode.info)
            shown = None if logged else show
            log = LoggedRun(begun, rover.log_dir, rover.settings, started=started, show=shown)
            logged.append(at_end.enter_context(log))
            lanes.append(Lane(injector(rover.config), log.advance, (*rover.observers, log)))
        ticks = drive_all(together(episodes), lanes, stop)
        why = _driven(ticks, Pacer(options.rate, sleep=stop.sleep), stop)
        return tuple(log.ended(*why) for log in logged)


class LoggedRun:
    """Logs a run whose samples go straight into the metrics: a sink of ticks, an Observer, a context.

    Args:
        begun: What is known of the run before its first batch.
        log_dir: Gets the log.
        settings: Of the metrics.
        started: Wall time at which the command began [s], of time.monotonic.
        show: Is told the result up to now after every batch.

    Raises:
        UsageError: The log cannot be created.
    """

    def __init__(
        self,
        begun: RunResult,
        log_dir: Path,
        settings: Settings,
        *,
        started: float,
        show: Show | None = None,
    ) -> None:
        self._settings = settings
        try:
            extended = settings.extended if settings.extended_columns else None
            session = MetricsSession(settings.thresholds, extended)
            self._log = log = CsvLog(log_dir, datetime.now(), columns=session.columns)
        except LogError as error:
            raise UsageError(str(error)) from error
        _mark(log, None)
        self._metrics = metrics = DirectMetrics(session, LidarSpec(beams=begun.config.lidar_beams), log)
        self.advance = metrics.advance

        space = f"/{begun.config.name}" if begun.config.name else ""

        def counts() -> dict[str, TopicCount]:
            return {f"{space}{topic}": TopicCount(n, n) for topic, n in metrics.fed.items()}

        begun = replace(begun, log_path=log.path)
        self._account = RunAccount(begun, started, show, counts, lambda: log.rows)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._log.close()

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        self._account.take(batch)

    def ended(self, failure: str | None = None, interrupted: str | None = None) -> RunResult:
        """Marks the log as complete or failed; returns what the run came to.

        Args:
            failure: Why it ended early; None if it did not.
            interrupted: The signal's name if somebody stopped it.
        """
        _mark(self._log, COMPLETE if failure is None else failed(failure))
        result = self._account.ended(failure=failure, interrupted=interrupted)
        last_row, thresholds = cells_of(self._metrics.last_row), self._settings.thresholds
        return replace(result, last_row=last_row, thresholds=thresholds)


def run_unlogged(
    config: EpisodeConfig, stop: StopRequest, samples: set[type[Sample]], observers: Sequence[Observer]
) -> RunResult:
    """Runs an episode with nothing but what its observers want; the truth is that of `run_direct`.

    No sample goes anywhere else, so faults have nothing to act on.

    Args:
        config: What to run.
        stop: Ends the run early.
        samples: What the observers want; the driver gets what it looks at all the same.
        observers: See every batch.

    Raises:
        UsageError: The arguments are not valid.
    """
    started = time.monotonic()
    episode = Episode(config, samples=samples | sensed_by(config.driver))
    begun = RunResult(config=config, mode="without a log", info=episode.info)
    account = RunAccount(begun, started, None, dict, int)
    faults = FaultInjector((), config.seed)
    ticks = drive(episode.batches(), faults, lambda *_: None, (*observers, account), stop)
    failure, interrupted = _driven(ticks, Pacer(None), stop)
    return account.ended(failure=failure, interrupted=interrupted)


def _driven(ticks: Iterator[Tick], pacer: Pacer, stop: StopRequest) -> tuple[str | None, str | None]:
    """Why a drive ended early, if it did: its failure, and the signal that stopped it."""
    try:
        with stop.deferred():
            for tick in ticks:
                pacer.wait_until(tick.stamp_ns)
    except (RunFailed, LogError) as error:
        return str(error), None
    return None, stop.name


def _mark(log: CsvLog, outcome: Outcome | None) -> None:
    """Says beside the log whether the session runs or has ended."""
    with suppress(LogError):  # what a disk refuses to the log itself is told already
        write_record(log.path, outcome, {})
