"""Runs without ROS: with a log, of the same CSV bytes; or without one, for the truth alone.

For machines without rclpy and for speed. What the MetricsNode's callbacks take from a message is taken
from the sample, in the same order: a tick's samples first, then the row if a second is full.
"""

import time
from collections.abc import Callable, Generator, Sequence
from contextlib import AbstractContextManager, ExitStack, closing, suppress
from dataclasses import replace
from datetime import datetime
from functools import partial
from pathlib import Path

from harness.base.errors import RunFailed, UsageError
from harness.base.interrupt import StopRequest
from harness.base.sim_time import NANOSECONDS
from harness.drivers import find_driver
from harness.episode.assembly import injector
from harness.episode.batch import Batch
from harness.episode.episode import Episode
from harness.episode.helm import Helm
from harness.episode.loop import Observer, Pacer, Route, drive
from harness.episode.metrics_feed import SampleFeed
from harness.episode.result import Outputs, RunAccount, RunResult, Show, TopicCount, cells_of
from harness.episode.stream import EpisodeStream
from harness.episode.together import Together
from harness.faults.injector import FaultInjector
from harness.messages.sink import sinks_of
from harness.robots.lidar import LidarSpec
from harness.samples import Sample, Tick
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from rover_metrics.core.columns import Row
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.errors import LogError
from rover_metrics.extended.settings import Settings
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.log.session_record import COMPLETE, Outcome, failed, write_record
from rover_metrics.session import MetricsSession
from rover_metrics.timing import RowSchedule


def run_direct(
    run: Run,
    outputs: Sequence[Outputs],
    options: RosOptions,
    stop: StopRequest,
    show: Show | None = None,
    helm: Helm | None = None,
) -> tuple[RunResult, ...]:
    """Runs without ROS and returns what each rover's part came to, also when it failed underway.

    Args:
        run: What to run.
        outputs: Of each rover.
        options: Its `rate` counts, and what is recorded and served.
        stop: Ends the run early.
        show: Is given the first rover's result up to now, again and again.
        helm: Steers the run; its rate counts. None where nobody does.

    Raises:
        UsageError: The arguments are not valid or a log cannot be created.
    """
    started = time.monotonic()
    with ExitStack() as at_end:
        sinks = sinks_of(options, at_end)
        frames = options.frames if sinks else None
        stream = EpisodeStream(run, frames, prompt=helm is not None, awake=options.rate is None)
        episodes = stream.begin()
        logged, routes = list[LoggedRun](), list[Route]()
        for episode, output in zip(episodes, outputs, strict=True):
            begun = RunResult(run=run, number=episode.number, mode="direct, no ROS", info=episode.info)
            shown = None if logged else show
            log = LoggedRun(
                begun,
                output.log_dir,
                output.settings,
                started=started,
                show=shown,
                diagnoses=bool(sinks),
                paused_s=float if helm is None else lambda: helm.held_s,
            )
            logged.append(at_end.enter_context(log))
            faults = injector(run, episode.number)
            routes.append(Route(faults, log.advance, (*output.observers, log)))
        if sinks:
            # Imported here: 20 ms that most runs save.
            from harness.episode.topics import RunTopics  # noqa: PLC0415

            described = [each.description for each in episodes if each.description is not None]
            routes = _published(routes, logged, RunTopics(run, described, sinks, at_end).tell)
        batches = stream.batches()
        if helm is not None:
            helm.metered = logged
            batches = helm.steered(stream)
        pacer = Pacer(options.rate, sleep=stop.sleep) if helm is None else helm
        why = _driven(drive(batches, routes, stop, stream.hasten), pacer, stop)
        recording = options.record if options.record is not None and options.record.exists() else None
        return tuple(replace(log.ended(*why), recording=recording) for log in logged)


class LoggedRun(AbstractContextManager["LoggedRun"]):
    """Logs a run whose samples go straight into the metrics: a sink of ticks, an Observer, a context.

    Args:
        begun: What is known of the run before its first batch.
        log_dir: Gets the log.
        settings: Of the metrics.
        started: Wall time at which the command began [s], of time.monotonic.
        show: Called with the result up to now, again and again.
        diagnoses: Whether to make, of each row, the message of diagnostics that metrics_node publishes.
        paused_s: Wall time for which the run was paused so far [s].

    Attributes:
        last_row: The latest row of the log; None before the first.
        diagnosis: What /rover/metrics says of the latest tick; None if that has no row.

    Raises:
        UsageError: The log cannot be created.
    """

    last_row: Row | None = None
    diagnosis: bytes | None = None

    def __init__(
        self,
        begun: RunResult,
        log_dir: Path,
        settings: Settings,
        *,
        started: float,
        show: Show | None = None,
        diagnoses: bool = False,
        paused_s: Callable[[], float] = float,
    ) -> None:
        try:
            extended = settings.extended if settings.extended_columns else None
            session = MetricsSession(settings.thresholds, extended)
            self._log = log = CsvLog(log_dir, datetime.now(), columns=session.columns)
        except LogError as error:
            raise UsageError(str(error)) from error
        _mark(log, None)
        self._session, self._schedule = session, RowSchedule(NANOSECONDS)
        self._feed = feed = SampleFeed(session, LidarSpec(beams=begun.rover.lidar_beams))
        space = f"/{begun.rover.name}" if begun.rover.name else ""
        if diagnoses:
            from harness.episode.diagnostics import Diagnostics  # noqa: PLC0415 - loads messages

            stale_after_ns = round(settings.stale_after * NANOSECONDS)
            feed.diagnostics = Diagnostics(session, space, stale_after_ns)

        def counts() -> dict[str, TopicCount]:
            return {f"{space}{topic}": TopicCount(n, n) for topic, n in feed.fed.items()}

        begun = replace(begun, log_path=log.path)
        self._account = RunAccount(begun, started, show, counts, lambda: log.rows, paused_s)

    def __exit__(self, *_: object) -> None:
        self._log.close()

    def advance(self, _: Tick, sent: Tick) -> None:
        """Takes what listeners get of a tick; the row of a full second comes after its samples."""
        self.diagnosis = None
        for sample in sent.samples:
            self._feed.take(sample)
        if sent.tells_time and self._schedule.is_due(sent.stamp_ns):
            self.last_row = row = self._session.row(sent.stamp_ns)
            self._log.write(row)
            if self._feed.diagnostics is not None:
                self.diagnosis = self._feed.diagnostics.message(sent.stamp_ns, row, self.thresholds)

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        self._account.take(batch)

    def ended(self, failure: str | None = None, interrupted: str | None = None) -> RunResult:
        """Marks the log as complete or failed; returns what the run came to.

        It failed for a reason, or was interrupted by the signal of that name, or neither.
        """
        _mark(self._log, COMPLETE if failure is None else failed(failure))
        result = self._account.ended(failure=failure, interrupted=interrupted)
        return replace(result, last_row=cells_of(self.last_row), thresholds=self.thresholds)

    @property
    def thresholds(self) -> Thresholds:
        """What counts as an event."""
        return self._session.metrics.thresholds

    def use(self, thresholds: Thresholds) -> None:
        """Replaces the thresholds from the next sample on."""
        self._session.metrics.thresholds = thresholds


def _published(
    routes: Sequence[Route],
    logs: Sequence[LoggedRun],
    tell: Callable[[Tick, Sequence[Tick], Sequence[bytes | None]], None],
) -> list[Route]:
    """The same routes, whose ticks are told to topics when all rovers have had theirs."""
    sent: list[Tick] = []

    def take(log: LoggedRun, tick: Tick, left: Tick) -> None:
        log.advance(tick, left)
        sent.append(left)
        if len(sent) == len(logs):
            tell(tick, sent, [each.diagnosis for each in logs])
            sent.clear()

    return [replace(route, sink=partial(take, log)) for route, log in zip(routes, logs, strict=True)]


def run_unlogged(
    run: Run, stop: StopRequest, samples: set[type[Sample]], observers: Sequence[Observer]
) -> RunResult:
    """Runs one rover with nothing but what its observers want, on the path of `run_direct`.

    No sample goes anywhere else, so faults have nothing to act on. The truth has slip only where
    TruthState is among the samples, which is what measures it.

    Args:
        run: What to run.
        stop: Ends the run early.
        samples: What the observers want; the driver gets what it looks at all the same.
        observers: See every batch.

    Raises:
        UsageError: The arguments are not valid.
    """
    started = time.monotonic()
    episode = Episode(run, samples=samples | find_driver(run.rover.driver).senses)
    begun = RunResult(run=run, mode="without a log", info=episode.info)
    account = RunAccount(begun, started, None, dict, int)
    route = Route(FaultInjector((), run.seed), lambda *_: None, (*observers, account))
    ticks = drive(Together((episode,)).batches(), (route,), stop)
    failure, interrupted = _driven(ticks, Pacer(None), stop)
    return account.ended(failure=failure, interrupted=interrupted)


def _driven(ticks: Generator[Tick], pacer: Pacer, stop: StopRequest) -> tuple[str | None, str | None]:
    """Why a drive ended early, if it did: its failure, and the signal that stopped it."""
    try:
        with stop.deferred(), closing(ticks):
            for tick in ticks:
                pacer.wait_until(tick.stamp_ns)
    except (RunFailed, LogError) as error:
        return str(error), None
    return None, stop.name


def _mark(log: CsvLog, outcome: Outcome | None) -> None:
    """Says beside the log whether the session runs or has ended."""
    with suppress(LogError):  # a disk that refuses the log itself is reported already
        write_record(log.path, outcome, {})
