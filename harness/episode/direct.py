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
from harness.episode.metrics_feed import SampleIntake, extended_settings
from harness.episode.pacing import Pacer
from harness.episode.result import Progress, RunResult, TopicCount
from harness.errors import RunFailed, UsageError
from harness.faults.injector import FaultInjector
from harness.faults.spec import parse_faults
from harness.interrupt import StopRequest
from harness.robots import find_rover
from harness.samples import GroundTruth, Imu, LaserScan, Odometry, Pose, Sample, Tick, TruthState
from harness.sensors.lidar_spec import LidarSpec
from harness.sim_time import NANOSECONDS
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.errors import LogError
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.log.session_record import COMPLETE, Outcome, failed, write_record
from rover_metrics.session import RowSource
from rover_metrics.timing.row_schedule import RowSchedule

if TYPE_CHECKING:
    from rover_metrics.core.row import Row

TOPICS: dict[type, tuple[str, ...]] = {
    LaserScan: ("/scan",),
    Imu: ("/imu/data",),
    Pose: ("/rover/pose_array",),
    Odometry: ("/odometry/wheels",),
}
TRUTH_TOPICS: dict[type, tuple[str, ...]] = {
    GroundTruth: ("/odom_ground_truth",),
    TruthState: ("/rover/truth/contact", "/rover/truth/traversal"),
}


class DirectMetrics:
    """Feeds ticks to the metric core and writes a row each simulated second.

    Args:
        log: Where the rows go.
        source: The metrics.
        extended: How samples get into the extended columns; None without.

    Attributes:
        fed: Samples taken, by the name of the topic that they would have had.
        last_row: The latest row, or None.
    """

    def __init__(self, log: CsvLog, source: RowSource, extended: SampleIntake | None = None) -> None:
        self.log, self._source, self._extended = log, source, extended
        self._topics = TOPICS if extended is None else TOPICS | TRUTH_TOPICS
        self.fed = {topic: 0 for topics in self._topics.values() for topic in topics}
        self._schedule = RowSchedule(NANOSECONDS)
        self.last_row: Row | None = None

    def take(self, tick: Tick) -> None:
        """Takes a tick; the row of a full second comes after its samples."""
        for sample in tick.samples:
            used = self._take_sample(sample)
            if self._extended is not None:
                self._extended.take(sample, used=used)
            for topic in self._topics.get(type(sample), ()):
                self.fed[topic] += 1
        if tick.tells_time and self._schedule.is_due(tick.stamp_ns):
            self.last_row = self._source.row(tick.stamp_ns)
            self.log.write(self.last_row)

    def messages(self) -> int:
        """Samples taken so far."""
        return sum(self.fed.values())

    def _take_sample(self, sample: Sample) -> bool:
        metrics = self._source.metrics
        match sample:
            case LaserScan():
                return metrics.add_scan(sample.ranges)
            case Imu():
                return metrics.add_imu(sample.linear_acceleration, sample.angular_velocity)
            case Pose():
                return metrics.add_pose(sample.position)
            case Odometry():
                return metrics.add_odometry((sample.twist.linear, 0.0, 0.0))
        return False


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
        source = RowSource(TraversalMetrics(), settings)
        log = CsvLog(log_dir, datetime.now(), columns=source.columns)
    except LogError as error:
        raise UsageError(str(error)) from error
    with log:
        _mark(log, None)
        intake = None
        if source.extended is not None:
            intake = SampleIntake(source.extended, LidarSpec(beams=config.lidar_beams))
        metrics = DirectMetrics(log, source, intake)
        account = RunAccount(
            RunResult(config=config, mode="direct, no ROS", info=episode.info, log_path=log.path),
            *(started, show, metrics.messages, lambda: log.rows),
        )
        pacer = Pacer(rate, sleep=stop.sleep)

        def sink(tick: Tick, sent: Tick) -> None:
            pacer.wait_until(tick.stamp_ns)
            metrics.take(sent)

        faults, failure = FaultInjector(parse_faults(config.faults), config.seed), None
        try:
            with stop.deferred():
                for _ in drive(episode.batches(), faults, sink, (account, *observers), stop):
                    pass
        except (RunFailed, LogError) as error:
            failure = str(error)
        _mark(log, COMPLETE if failure is None else failed(failure))
        return _counted(account.ended(failure=failure, interrupted=stop.name), metrics)


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
        last_row=None if row is None else dict(zip(row.columns, row.as_fields(), strict=True)),
    )
