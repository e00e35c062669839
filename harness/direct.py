"""A run without ROS: the same samples straight into TraversalMetrics, the same CSV bytes.

For machines without rclpy and for speed. What the MetricsNode's callbacks take from a message is taken
here from the sample, in the same order: a tick's samples first, then the row if a second is full.
"""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from harness.config import Batch, EpisodeConfig
from harness.episode import Episode
from harness.errors import RunFailed, UsageError
from harness.interrupt import StopRequest
from harness.pacing import Pacer
from harness.result import Progress, RunResult, TopicCount
from harness.row_schedule import RowSchedule
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, Tick
from harness.sensors.fault_spec import parse_faults
from harness.sensors.faults import FaultInjector
from harness.sim_time import NANOSECONDS
from harness.truth_account import TruthAccount
from rover_metrics.csv_log import CsvLog
from rover_metrics.errors import LogError
from rover_metrics.metrics import TraversalMetrics
from rover_metrics.row import COLUMNS, MetricsRow
from rover_metrics.session_record import COMPLETE, Outcome, failed, write_record

TOPICS: dict[type, str] = {
    LaserScan: "/scan",
    Imu: "/imu/data",
    Pose: "/rover/pose_array",
    Odometry: "/odometry/wheels",
}


class DirectMetrics:
    """Feeds ticks to the metric core and writes a row each simulated second.

    Attributes:
        fed: Samples taken, by the name of the topic that they would have had.
        last_row: The latest row, or None.
    """

    def __init__(self, log: CsvLog, metrics: TraversalMetrics) -> None:
        self.log, self._metrics = log, metrics
        self.fed = dict.fromkeys(TOPICS.values(), 0)
        self._schedule = RowSchedule(NANOSECONDS)
        self.last_row: MetricsRow | None = None

    def take(self, tick: Tick) -> None:
        """Takes a tick; the row of a full second comes after its samples."""
        for sample in tick.samples:
            self._take_sample(sample)
        if tick.tells_time and self._schedule.is_due(tick.stamp_ns):
            self.last_row = self._metrics.row(tick.stamp_ns // NANOSECONDS)
            self.log.write(self.last_row)

    def _take_sample(self, sample: Sample) -> None:
        match sample:
            case LaserScan():
                self._metrics.add_scan(sample.ranges)
            case Imu():
                self._metrics.add_imu(sample.linear_acceleration, sample.angular_velocity)
            case Pose():
                self._metrics.add_pose(sample.position)
            case Odometry():
                self._metrics.add_odometry((sample.twist.linear, 0.0, 0.0))
            case _:
                return
        self.fed[TOPICS[type(sample)]] += 1


def run_direct(
    config: EpisodeConfig,
    log_dir: Path,
    rate: float | None,
    stop: StopRequest,
    show: Callable[[Progress], None],
    watch: Callable[[Batch], None] | None = None,
) -> RunResult:
    """Runs an episode without ROS and returns what it came to, also when it failed underway.

    Args:
        config: What to run.
        log_dir: Folder for the metrics CSV.
        rate: Simulated seconds per wall second; None is as fast as possible.
        stop: Ends the run early.
        show: Is told the progress after every batch.
        watch: Sees every batch once it has been taken.

    Raises:
        UsageError: The arguments are not valid or the log cannot be created.
    """
    started = time.monotonic()
    episode = Episode(config)
    try:
        log = CsvLog(log_dir, datetime.now())
    except LogError as error:
        raise UsageError(str(error)) from error
    with log:
        _mark(log, None)
        metrics = DirectMetrics(log, TraversalMetrics())
        result = RunResult(config=config, mode="direct, no ROS", info=episode.info, log_path=log.path)
        begun = time.monotonic()
        pacer = Pacer(rate, sleep=stop.sleep)
        faults, account = FaultInjector(parse_faults(config.faults), config.seed), TruthAccount()
        try:
            with stop.deferred():
                for batch in episode.batches():
                    for tick in batch.ticks:
                        pacer.wait_until(tick.stamp_ns)
                        metrics.take(faults.corrupt(tick))
                    account.take(batch)
                    if watch is not None:
                        watch(batch)
                    now = time.monotonic()
                    if result.first_row_s is None and log.rows:
                        result = replace(result, first_row_s=now - started)
                    result = replace(result, truth=batch.truth, wall_s=now - begun)
                    show(_progress(result, metrics))
                    if stop.signal is not None:
                        result = replace(result, interrupted=stop.signal.name)
                        break
        except (RunFailed, LogError) as error:
            result = replace(result, failure=str(error))
        _mark(log, COMPLETE if result.failure is None else failed(result.failure))
        return _counted(replace(result, along=account.along()), metrics)


def _progress(result: RunResult, metrics: DirectMetrics) -> Progress:
    return Progress(
        simulated_s=result.simulated_s,
        total_s=result.config.duration,
        wall_s=result.wall_s,
        path_length=result.truth.path_length,
        messages=sum(metrics.fed.values()),
    )


def _mark(log: CsvLog, outcome: Outcome | None) -> None:
    """Says beside the log whether the session runs or has ended."""
    with suppress(LogError):  # what a disk refuses to the log itself is told already
        write_record(log.path, outcome, {})


def _counted(result: RunResult, metrics: DirectMetrics) -> RunResult:
    row = metrics.last_row
    return replace(
        result,
        topics={name: TopicCount(published=n, received=n) for name, n in metrics.fed.items()},
        rows=metrics.log.rows,
        last_row=None if row is None else dict(zip(COLUMNS, row.as_fields(), strict=True)),
    )
