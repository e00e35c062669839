"""A run without ROS: the same samples straight into TraversalMetrics, the same CSV bytes.

For machines without rclpy and for speed. What the MetricsNode's callbacks take from a message is taken
here from the sample, in the same order: a tick's samples first, then the row if a second is full.
"""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from harness.config import EpisodeConfig
from harness.episode.episode import Episode
from harness.episode.loop import Observer, RunAccount, drive
from harness.episode.metrics_feed import SampleFeed, extended_settings
from harness.episode.pacing import Pacer
from harness.episode.result import Progress, RunResult, TopicCount
from harness.errors import RunFailed, UsageError
from harness.faults.injector import FaultInjector
from harness.faults.spec import parse_faults
from harness.interrupt import StopRequest
from harness.robots import find_rover
from harness.samples import Tick
from harness.sensors.lidar_spec import LidarSpec
from harness.sim_time import NANOSECONDS
from rover_metrics.errors import LogError
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.log.session_record import COMPLETE, Outcome, failed, write_record
from rover_metrics.session import MetricsSession
from rover_metrics.timing.row_times import RowSchedule

if TYPE_CHECKING:
    from rover_metrics.core.row import Row


class DirectMetrics:
    """Feeds ticks to a session of metrics and writes a row each simulated second.

    Args:
        log: Where the rows go.
        session: The metrics.
        lidar: Whose scans they are made of.

    Attributes:
        feed: Counts the samples taken.
        last_row: The latest row, or None.
    """

    def __init__(self, log: CsvLog, session: MetricsSession, lidar: LidarSpec) -> None:
        self.log, self._session = log, session
        self.feed = SampleFeed(session, lidar)
        self._schedule = RowSchedule(NANOSECONDS)
        self.last_row: Row | None = None

    def take(self, tick: Tick) -> None:
        """Takes a tick; the row of a full second comes after its samples."""
        for sample in tick.samples:
            self.feed.take(sample)
        if tick.tells_time and self._schedule.is_due(tick.stamp_ns):
            self.last_row = self._session.row(tick.stamp_ns)
            self.log.write(self.last_row)


def run_direct(
    config: EpisodeConfig,
    log_dir: Path,
    rate: float | None,
    stop: StopRequest,
    show: Callable[[Progress], None],
    observers: Sequence[Observer] = (),
    *,
    extended: bool = False,
) -> RunResult:
    """Runs an episode without ROS and returns what it came to, also when it failed underway.

    Args:
        config: What to run.
        log_dir: Folder for the metrics CSV.
        rate: Simulated seconds per wall second; None is as fast as possible.
        stop: Ends the run early.
        show: Is told the progress after every batch.
        observers: See every batch once it has been taken.
        extended: Whether to write the extended columns too.

    Raises:
        UsageError: The arguments are not valid or the log cannot be created.
    """
    started = time.monotonic()
    episode = Episode(config)
    try:
        settings = extended_settings(find_rover(config.robot)) if extended else None
        session = MetricsSession(settings=settings)
        log = CsvLog(log_dir, datetime.now(), columns=session.columns)
    except LogError as error:
        raise UsageError(str(error)) from error
    with log:
        _mark(log, None)
        metrics = DirectMetrics(log, session, LidarSpec(beams=config.lidar_beams))
        account = RunAccount(
            RunResult(config=config, mode="direct, no ROS", info=episode.info, log_path=log.path),
            *(started, show, lambda: sum(metrics.feed.fed.values()), lambda: log.rows),
        )
        pacer = Pacer(rate, sleep=stop.sleep)

        def sink(tick: Tick, sent: Tick) -> None:
            pacer.wait_until(tick.stamp_ns)
            metrics.take(sent)

        faults = FaultInjector(parse_faults(config.faults), config.seed)
        failure, interrupted = None, None
        try:
            with stop.deferred():
                for _ in drive(episode.batches(), faults, sink, (*observers, account), stop):
                    pass
            interrupted = stop.name
        except (RunFailed, LogError) as error:
            failure = str(error)
        _mark(log, COMPLETE if failure is None else failed(failure))
        return _counted(account.ended(failure=failure, interrupted=interrupted), metrics)


def _mark(log: CsvLog, outcome: Outcome | None) -> None:
    """Says beside the log whether the session runs or has ended."""
    with suppress(LogError):  # what a disk refuses to the log itself is told already
        write_record(log.path, outcome, {})


def _counted(result: RunResult, metrics: DirectMetrics) -> RunResult:
    row = metrics.last_row
    return replace(
        result,
        topics={name: TopicCount(published=n, received=n) for name, n in metrics.feed.fed.items()},
        rows=metrics.log.rows,
        last_row=None if row is None else dict(zip(row.columns, row.as_fields(), strict=True)),
    )
