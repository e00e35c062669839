"""Runs without ROS: with a log, the same CSV bytes; without, for whoever asks for the truth alone.

For machines without rclpy and for speed. What the MetricsNode's callbacks take from a message is taken
from the sample, in the same order: a tick's samples first, then the row if a second is full.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import datetime

from harness.config import EpisodeConfig, RosOptions
from harness.drivers import LOOKING
from harness.episode.episode import Episode
from harness.episode.loop import Observer, Pacer, drive
from harness.episode.metrics_feed import DirectMetrics
from harness.episode.result import RunAccount, RunResult, TopicCount, cells_of
from harness.errors import RunFailed, UsageError
from harness.faults.injector import FaultInjector
from harness.faults.spec import parse_faults
from harness.interrupt import StopRequest
from harness.samples import LaserScan, Sample, Tick
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
    show: Callable[[RunResult], None] | None = None,
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
    started = time.monotonic()
    episode = Episode(config)
    try:
        extended = settings.extended if settings.extended_columns else None
        session = MetricsSession(settings.thresholds, extended)
        log = CsvLog(options.log_dir, datetime.now(), columns=session.columns)
    except LogError as error:
        raise UsageError(str(error)) from error
    with log:
        _mark(log, None)
        metrics = DirectMetrics(session, LidarSpec(beams=config.lidar_beams), log)

        def counts() -> dict[str, TopicCount]:
            return {topic: TopicCount(published=n, received=n) for topic, n in metrics.fed.items()}

        begun = RunResult(config=config, mode="direct, no ROS", info=episode.info, log_path=log.path)
        account = RunAccount(begun, started, show, counts, lambda: log.rows)
        faults = FaultInjector(parse_faults(config.faults), config.seed)
        pacer = Pacer(options.rate, sleep=stop.sleep)
        ticks = drive(episode.batches(), faults, metrics.advance, (*observers, account), stop)
        result = _driven(ticks, account, pacer, stop)
        _mark(log, COMPLETE if result.failure is None else failed(result.failure))
        return replace(result, last_row=cells_of(metrics.last_row), thresholds=settings.thresholds)


def run_unlogged(
    config: EpisodeConfig, stop: StopRequest, samples: set[type[Sample]], observers: Sequence[Observer]
) -> RunResult:
    """Runs an episode with nothing but what its observers want; the truth is that of `run_direct`.

    No sample goes anywhere else, so faults have nothing to act on.

    Args:
        config: What to run.
        stop: Ends the run early.
        samples: What the observers want; the driver gets its scans all the same.
        observers: See every batch.

    Raises:
        UsageError: The arguments are not valid.
    """
    started = time.monotonic()
    scans = {LaserScan} if config.driver in LOOKING else set()
    episode = Episode(config, samples=samples | scans)
    begun = RunResult(config=config, mode="without a log", info=episode.info)
    account = RunAccount(begun, started, None, dict, int)
    faults = FaultInjector((), config.seed)
    ticks = drive(episode.batches(), faults, lambda *_: None, (*observers, account), stop)
    return _driven(ticks, account, Pacer(None), stop)


def _driven(ticks: Iterator[Tick], account: RunAccount, pacer: Pacer, stop: StopRequest) -> RunResult:
    """What a drive came to, also if it failed underway."""
    failure, interrupted = None, None
    try:
        with stop.deferred():
            for tick in ticks:
                pacer.wait_until(tick.stamp_ns)
        interrupted = stop.name
    except (RunFailed, LogError) as error:
        failure = str(error)
    return account.ended(failure=failure, interrupted=interrupted)


def _mark(log: CsvLog, outcome: Outcome | None) -> None:
    """Says beside the log whether the session runs or has ended."""
    with suppress(LogError):  # what a disk refuses to the log itself is told already
        write_record(log.path, outcome, {})
