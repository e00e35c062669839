"""A run through ROS 2: child simulation -> bridge -> topics -> MetricsNode, in lock-step."""

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, nullcontext
from dataclasses import replace
from functools import partial

from rclpy.executors import ExternalShutdownException

from harness.config import EpisodeConfig, RosOptions
from harness.episode.loop import Observer, Pacer, drive
from harness.episode.result import RunAccount, RunResult, TopicCount, cells_of
from harness.episode.stream import EpisodeProcess
from harness.errors import RunFailed
from harness.faults.injector import FaultInjector
from harness.faults.spec import parse_faults
from harness.interrupt import GRACE, Overdue, StopRequest
from harness.robots import find_rover
from harness.ros.bridge import SECOND_PUBLISHER, Bridge
from harness.ros.camera import painter
from harness.ros.context import make_executor, ros_context, spin_until
from harness.ros.controls import Controls
from harness.ros.hosted import HostedMetrics, metrics_node
from harness.ros.lock_step import RemoteNodes
from harness.ros.navigation import Navigation
from harness.ros.recorder import Recorder
from harness.ros.remote import ANSWER_PATIENCE, DISCOVERY_PATIENCE, RemoteNode, counted_by
from harness.sensors.lidar_spec import LidarSpec
from harness.sim_time import NANOSECONDS
from rover_metrics.ros.metrics_publisher import MetricsPublisher

LOOK_PERIOD_NS = NANOSECONDS // 10  # of simulation time, for publishers that have turned up


def run_through_ros(
    config: EpisodeConfig,
    options: RosOptions,
    stop: StopRequest,
    show: Callable[[RunResult], None] | None = None,
    observers: Sequence[Observer] = (),
) -> RunResult:
    """Runs an episode and returns what it came to, also when it failed underway.

    Args:
        config: What to run.
        options: How it goes through ROS.
        stop: Ends the run early.
        show: Is told the result up to now after every batch.
        observers: See every batch once it has been published.

    Raises:
        UsageError: Something is wrong with the arguments or the environment.
    """
    started = time.monotonic()
    with ExitStack() as at_end:
        recorder = Recorder(options.record, overwrite=options.overwrite) if options.record else None
        at_end.enter_context(recorder or nullcontext())
        source = at_end.enter_context(EpisodeProcess(config, options.frames))
        run = _Run(config, options, source, at_end)
        if recorder is not None:
            recorder.tap(run.bridge, run.metrics, [run.navigation.map])
        return run.drive(stop, show, observers, started)


class _Run:
    """The nodes of one run and its loop."""

    def __init__(
        self, config: EpisodeConfig, options: RosOptions, source: EpisodeProcess, at_end: ExitStack
    ) -> None:
        self._config, self._options, self._source = config, options, source
        self._context = context = at_end.enter_context(ros_context(options.ros_args))
        rover, lidar = find_rover(config.robot), LidarSpec(beams=config.lidar_beams)
        rows, draw = config.sensor_rows(), at_end.enter_context(painter(config)).image
        self.bridge = Bridge(
            rover,
            lidar,
            context=context,
            on_command=source.command,
            cmd_vel=options.cmd_vel,
            rows=rows,
            draw=draw,
            actors=config.actor_names(),
        )
        at_end.callback(self.bridge.destroy_node)
        self._faults = FaultInjector(parse_faults(config.faults, rows), config.seed, rows)
        executor = make_executor(context, time_jumps=self._faults.disturbs_time)
        self._executor = at_end.enter_context(executor)
        self._executor.add_node(self.bridge)
        self.navigation = Navigation(self.bridge, config, source)
        self._controls = Controls(self.bridge, source.reset)
        self._hosted: HostedMetrics | None = None
        if options.host_metrics:
            node = metrics_node(context, options.log_dir)
            at_end.callback(node.destroy_node)
            self._executor.add_node(node)
            self._hosted = HostedMetrics(self.bridge, node)
            self._hosted.await_match()
        jumps = self._faults.disturbs_time
        remote = partial(RemoteNode, bridge=self.bridge, time_jumps=jumps)
        self._remotes = [remote(name) for name in options.wait_for]
        heard = self.bridge.commands.heard
        spin_until(self._executor, self.bridge.commands.look_around, DISCOVERY_PATIENCE)
        if self.bridge.commands.heard != heard:  # the nodes know of it when new clients are answered
            self._remotes = [remote(name) for name in options.wait_for]

    def drive(
        self,
        stop: StopRequest,
        show: Callable[[RunResult], None] | None,
        observers: Sequence[Observer],
        started: float,
    ) -> RunResult:
        """Publishes the episode tick by tick until its end, a failure or a stop request."""
        info = self._source.info  # waits for the world: other runs are discovered by then
        self._executor.spin_once(timeout_sec=0.0)
        self.bridge.refuse_other_publishers(self._hosted.topics if self._hosted else ())
        if (description := self._source.description) is not None:
            self.bridge.describe(description)
        account = RunAccount(
            RunResult(config=self._config, mode=self._mode(), info=info),
            started,
            show,
            topics=lambda: {topic: TopicCount(n) for topic, n in self.bridge.published().items()},
            rows=lambda: 0 if self._hosted is None else self._hosted.node.rows,
            paused_s=lambda: self._controls.held_s,
        )
        failure, interrupted = None, None
        try:
            with stop.deferred():
                self._controls.hold(stop)
                pacer = Pacer(self._options.rate, sleep=stop.sleep)
                remotes = (RemoteNodes(self._remotes, self.bridge),) if self._remotes else ()
                hosted = (self._hosted,) if self._hosted else ()  # has its turns while others answer
                sink = partial(self.bridge.advance, listeners=(*remotes, *hosted))
                batches, watching = self._source.batches(), (*observers, account)
                for tick in drive(batches, self._faults, sink, watching, stop):
                    pacer.postpone(self._controls.hold(stop))
                    pacer.wait_until(tick.stamp_ns)
                    if tick.stamp_ns % LOOK_PERIOD_NS == 0:
                        self.bridge.commands.look_around()
                        self.navigation.look_around()
            interrupted = stop.name
        except RunFailed as error:
            failure = str(error)
        except Overdue as error:
            self._remotes = []  # one of them hangs: it will not tell what it has received
            interrupted = error.signal.name
        except (ExternalShutdownException, RuntimeError):
            if self._context.ok():
                raise
            self._remotes = []
            failure = "ROS 2 was shut down from outside this run"
        return self._counted(account.ended(failure=failure, interrupted=interrupted))

    @property
    def metrics(self) -> MetricsPublisher | None:
        """What the hosted metrics_node publishes with."""
        return None if self._hosted is None else self._hosted.node.publisher

    def _mode(self) -> str:
        hosted = "hosted metrics_node" if self._hosted else "no metrics_node"
        waited = f", lock-step with {', '.join(self._options.wait_for)}" if self._remotes else ""
        return f"ROS 2, {hosted}{waited}"

    def _counted(self, result: RunResult) -> RunResult:
        topics = result.topics
        if self._hosted:
            for topic, received in self._hosted.received().items():
                topics[topic] = replace(topics[topic], received=received, lost=self._hosted.lost[topic])
        patience = ANSWER_PATIENCE if result.interrupted is None else GRACE
        topics = counted_by(self._remotes, topics, patience)
        waited = {remote.name: remote.waited_s for remote in self._remotes}
        failure = result.failure
        foreign = [topic for topic, count in topics.items() if count.published < (count.received or 0)]
        if failure is None and foreign:
            failure = f"{foreign[0]} {SECOND_PUBLISHER}"
        recording = self._options.record if any(c.published for c in topics.values()) else None
        result = replace(
            result,
            topics=topics,
            recording=recording,
            failure=failure,
            waited_s=waited,
            commands=self.bridge.commands.count,
        )
        if self._hosted is None:
            return result
        node = self._hosted.node
        node.log.close()  # what waits for the disk is tried a last time, then it is lost
        if failure is None and node.lost_rows:
            failure = f"{node.lost_rows} rows could not be written"
        return replace(
            result,
            failure=failure,
            rows=node.rows,
            log_path=node.log.path,
            last_row=cells_of(node.last_row),
            thresholds=node.settings.thresholds,
            reception=node.reception.account(),
            segments=node.timer.times.segments,
        )
