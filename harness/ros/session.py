"""A run through ROS 2: episodes -> bridges -> topics -> MetricsNodes, in lock-step.

Each rover of the run has a bridge and a MetricsNode, in the namespace of its name if there are several.
The first one's bridge publishes /clock, when all have sent the samples of a tick.
"""

import time
from collections import Counter
from collections.abc import Generator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial

from rclpy.executors import ExternalShutdownException

from harness.base.errors import RunFailed, UsageError
from harness.base.interrupt import GRACE, Overdue, StopRequest
from harness.base.sim_time import CONTROL_PERIOD_NS, LOOK_PERIOD_NS
from harness.episode.batch import Batch
from harness.episode.helm import Helm
from harness.episode.loop import Pacer, Route, drive
from harness.episode.result import Outputs, RunAccount, RunResult, Show
from harness.episode.stream import EpisodeStream
from harness.messages.sink import sinks_of
from harness.ros.bridge import SECOND_PUBLISHER, Listener
from harness.ros.context import (
    NOTICED,
    SPIN_TIMEOUT,
    Interval,
    make_executor,
    ros_context,
    serve_waiting,
    spin_until,
)
from harness.ros.controls import Controls
from harness.ros.effect import AwaitedEffect
from harness.ros.hosted import heard_by
from harness.ros.lock_step import RemoteNodes
from harness.ros.remote import ANSWER_PATIENCE, DISCOVERY_PATIENCE, RemoteNode, counted_by
from harness.ros.rover_nodes import RoverNodes
from harness.ros.tap import Tap
from harness.samples import Tick
from harness.spec.ros import RosOptions
from harness.spec.rover import CMD_VEL
from harness.spec.run import Run


def run_through_ros(
    run: Run,
    outputs: Sequence[Outputs],
    options: RosOptions,
    stop: StopRequest,
    show: Show | None = None,
    helm: Helm | None = None,
) -> tuple[RunResult, ...]:
    """Runs through ROS and returns what each rover's part came to, also when it failed underway.

    Args:
        run: What to run.
        outputs: Of each rover.
        options: How it goes through ROS.
        stop: Ends the run early.
        show: Is given the first rover's result up to now, again and again.
        helm: Steers the run; its rate counts. None where nobody does.

    Raises:
        UsageError: Something is wrong with the arguments or the environment.
    """
    started = time.monotonic()
    with ExitStack() as at_end:
        sinks = sinks_of(options, at_end)
        session = _Session(run, outputs, options, at_end, steered=helm is not None)
        tap = Tap(*sinks)
        for rover in session.rovers if sinks else ():
            metrics = rover.hosted.node.publisher if rover.hosted else None
            tap.tap(rover.bridge, metrics, rover.navigation.maps)
        return session.drive(stop, show, started, helm)


class _Session:
    """The nodes of one run and its loop."""

    def __init__(
        self,
        run: Run,
        outputs: Sequence[Outputs],
        options: RosOptions,
        at_end: ExitStack,
        *,
        steered: bool,
    ) -> None:
        self._run, self._outputs, self._options = run, outputs, options
        prompt = steered or any(rover.driver == CMD_VEL for rover in run.rovers)
        self._source = source = EpisodeStream(
            run, options.frames, prompt=prompt, awake=options.rate is None
        )
        # Else somebody acts between two periods, and when he does must not depend on how fast we are.
        is_alone = not (prompt or options.wait_for or options.wait_for_topic)
        pause = NOTICED if is_alone else 0.0
        self._meanwhile = source.hasten if is_alone else lambda: None
        self._serving, self._looking = Interval(pause), Interval(pause)
        self._context = context = at_end.enter_context(ros_context(options.ros_args))
        self.rovers: list[RoverNodes] = []
        for number, orders in enumerate(source.rovers):
            more = {"cmd_vel": options.cmd_vel, "context": context}
            clock = self.rovers[0].bridge.clock_channel if self.rovers else None
            self.rovers.append(RoverNodes(run, number, orders.command, at_end, clock=clock, **more))
        names = Counter(channel.topic for rover in self.rovers for channel in rover.bridge.channels)
        if shared := [name for name, count in names.items() if count > 1]:
            raise UsageError(
                f"{shared[0]} would be {names[shared[0]]} topics of this run in one; remap each to a "
                "name of its own, of several rovers to one without a slash in front"
            )
        jumps = any(rover.faults.disturbs_time for rover in self.rovers)
        self._executor = at_end.enter_context(make_executor(context))  # no timer on ROS time is its own
        for rover, orders in zip(self.rovers, source.rovers, strict=True):
            self._executor.add_node(rover.bridge)
            rover.navigate(orders, truth_map=options.truth_map)
        resets = [(r.bridge, orders.reset) for r, orders in zip(self.rovers, source.rovers, strict=True)]
        self._controls = Controls(resets)
        for rover, output in zip(self.rovers, outputs, strict=True) if options.host_metrics else ():
            rover.host_metrics(self._executor, output)
        self._remotes = self._remote_nodes(time_jumps=jumps)
        heard = [rover.bridge.commands.heard for rover in self.rovers]
        for rover in self.rovers:
            spin_until(self._executor, rover.bridge.commands.look_around, DISCOVERY_PATIENCE)
        if [rover.bridge.commands.heard for rover in self.rovers] != heard:
            # The nodes know of it when new clients are answered.
            self._remotes = self._remote_nodes(time_jumps=jumps)
        bridges = [rover.bridge for rover in self.rovers]
        self._effects = [AwaitedEffect(effect, bridges) for effect in options.wait_for_topic]
        self._sent: Tick | None = None

    def _remote_nodes(self, *, time_jumps: bool) -> list[RemoteNode]:
        """The nodes elsewhere; of several rovers none has a namespace that they could be below."""
        first, *others = (rover.bridge for rover in self.rovers)
        root = "/" if self._run.rover.name else ""
        names = (n if n.startswith("/") else root + n for n in self._options.wait_for)
        return [RemoteNode(name, first, time_jumps=time_jumps, others=others) for name in names]

    def drive(
        self, stop: StopRequest, show: Show | None, started: float, helm: Helm | None
    ) -> tuple[RunResult, ...]:
        """Publishes the episodes tick by tick until their end, a failure or a stop request."""
        episodes = self._source.begin()  # takes its time: other runs are discovered by then
        serve_waiting(self._executor)
        for rover, episode in zip(self.rovers, episodes, strict=True):
            rover.begin(episode.description)
        serve_waiting(self._executor)  # who has just come gets all in its order
        accounts = [
            RunAccount(
                RunResult(run=self._run, number=rover.number, mode=self._mode(), info=episode.info),
                started,
                None if rover.number else show,
                topics=rover.topics,
                rows=rover.rows,
                paused_s=lambda: self._controls.held_s + (helm.held_s if helm else 0.0),
            )
            for rover, episode in zip(self.rovers, episodes, strict=True)
        ]
        failure, interrupted = None, None
        try:
            with stop.deferred():
                self._controls.hold(stop)
                pacer = Pacer(self._options.rate, sleep=stop.sleep) if helm is None else helm
                for tick in drive(self._batches(helm), self._routes(accounts), stop, self._meanwhile):
                    pacer.postpone(self._controls.hold(stop))
                    pacer.wait_until(tick.stamp_ns)
                    if tick.stamp_ns % LOOK_PERIOD_NS == 0 and self._looking.is_over():
                        for rover in self.rovers:
                            rover.look_around()
            interrupted = stop.name
        except RunFailed as error:
            failure = str(error)
        except Overdue as error:
            self._remotes = []  # one of them hangs: it will not say what it has received
            interrupted = error.signal.name
        except (ExternalShutdownException, RuntimeError):
            if self._context.ok():
                raise
            self._remotes = []
            failure = "ROS 2 was shut down from outside this run"
        ended = [account.ended(failure=failure, interrupted=interrupted) for account in accounts]
        return self._counted(ended)

    def _batches(self, helm: Helm | None) -> Generator[tuple[Batch, ...]]:
        """The batches of each control period, between which a helm's orders are handed on."""
        if helm is None:
            return self._source.batches()
        helm.metered = [rover.hosted for rover in self.rovers if rover.hosted is not None]
        helm.idle = partial(self._executor.spin_once, timeout_sec=SPIN_TIMEOUT)
        return helm.steered(self._source)

    def _routes(self, accounts: Sequence[RunAccount]) -> list[Route]:
        """Where the ticks and the batches of each rover go."""
        first = self.rovers[0].bridge
        remotes: list[Listener] = [RemoteNodes(self._remotes, first)] if self._remotes else []
        remotes += self._effects
        # Hosted nodes come last: they have their turns while others answer.
        everybody = (*remotes, *(node for rover in self.rovers for node in rover.listeners))
        others = [rover.bridge for rover in self.rovers[1:]]

        def send(rover: RoverNodes, tick: Tick, sent: Tick) -> None:
            if rover is self.rovers[0]:
                self._sent = sent
            rover.bridge.send(tick, sent, listeners=(*remotes, *rover.listeners))
            if rover is self.rovers[-1] and self._sent is not None:
                first.publish_clock(self._sent, listeners=everybody, others=others)
                if tick.stamp_ns % CONTROL_PERIOD_NS == 0 and self._serving.is_over():
                    serve_waiting(self._executor)  # /cmd_vel, parameters and other services

        return [
            Route(rover.faults, partial(send, rover), (*output.observers, account))
            for rover, output, account in zip(self.rovers, self._outputs, accounts, strict=True)
        ]

    def _mode(self) -> str:
        hosted = "hosted metrics_node" if self._options.host_metrics else "no metrics_node"
        names = [*self._options.wait_for, *(effect.name for effect in self._effects)]
        waited = f", lock-step with {', '.join(names)}" if names else ""
        return f"ROS 2, {hosted}{waited}"

    def _counted(self, results: Sequence[RunResult]) -> tuple[RunResult, ...]:
        """The results with what was received, and what is in the logs."""
        published = {topic: count for result in results for topic, count in result.topics.items()}
        hosts = [rover.hosted for rover in self.rovers if rover.hosted]
        for host in hosts if self._context.ok() else ():
            host.take_all()
        topics = heard_by(hosts, published)
        patience = ANSWER_PATIENCE if results[0].interrupted is None else GRACE
        topics = counted_by(self._remotes, topics, patience)
        waited = {remote.name: remote.waited_s for remote in self._remotes}
        waited |= {effect.name: effect.waited_s for effect in self._effects}
        recorded = any(count.published for count in topics.values())
        counted = []
        for result, rover in zip(results, self.rovers, strict=True):
            own = {topic: topics[topic] for topic in result.topics}
            foreign = [topic for topic, c in own.items() if c.published < (c.received or 0)]
            failure = result.failure
            if failure is None and foreign:
                failure = f"{foreign[0]} {SECOND_PUBLISHER}"
            with_counts = replace(
                result,
                topics=own,
                recording=self._options.record if recorded else None,
                failure=failure,
                waited_s=waited,
                commands=rover.bridge.commands.count,
                refusal=rover.bridge.commands.refusal,
            )
            counted.append(rover.logged(with_counts))
        return tuple(counted)
