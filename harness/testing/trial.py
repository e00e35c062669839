"""A trial: one seeded drive whose topics a node under test hears, stepped by the test."""

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any, Self, TypeVar

import rclpy
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions

from harness.base.errors import RunFailed, UsageError
from harness.base.sim_time import LOOK_PERIOD_NS, NANOSECONDS, TICK_NS
from harness.episode.assembly import check
from harness.episode.batch import Batch, later
from harness.episode.episode import Episode
from harness.episode.loop import Route
from harness.episode.loop import drive as drive_loop
from harness.ros.context import QUIET, make_executor, spin_until, spin_until_quiet, unfinished_is_freed
from harness.ros.network import reserved_domain, stay_local
from harness.ros.remote import DISCOVERY_PATIENCE
from harness.ros.rover_nodes import RoverNodes
from harness.samples import GroundTruth, Tick, Truth, Twist
from harness.spec.ros import FrameOptions
from harness.spec.run import Run
from harness.testing.evidence import Evidence, LeavesEvidence, Recording
from harness.testing.listener import TrialListener
from harness.testing.nodes import Nodes
from harness.testing.process import Programs
from harness.testing.subject import Heard, Message
from rover_metrics.ros.parameters import BEST_EFFORT
from rover_metrics.ros.subscriptions import keep_last

MOST = 10_000  # messages of a topic that are kept: over three minutes at 50 Hz
ON_SIMULATED_TIME = ("--ros-args", "-p", "use_sim_time:=true")
# Hears reliable publishers and best-effort ones; in lock-step nothing is lost.
ANYTHING = keep_last(1000, BEST_EFFORT)

Node = TypeVar("Node")
Start = tuple[float, float, float]


class Trial(LeavesEvidence):
    """Publishes a rover's topics in a ROS domain of its own; a context manager, one at a time.

    Args:
        run: The world, the rover, its driver and faults. Driver "cmd_vel" obeys `drive` and
            /cmd_vel, whichever spoke last.
        artifacts: Folder for a recording and a page, if an exception ends the trial; None for none.
        frames: Which transforms are published; None for those of a run.
        listener: Follows what happens; None for nobody.
        recording: Records the topics; None if that is done for `artifacts` only.
        cmd_vel: How commands come, as `Commands` says; by default in the type of the first to send.

    Attributes:
        run: As it was given, or as `reset` has changed it; `domain` is its ROS domain.
        artifacts: As it was given; may be changed until the trial is entered.
        speed: True forward speed of the rover [m/s].
        truth: What only the simulator knows, at the end of the present control period of 50 ms.
        failure: Why the drive itself ended early; None if it did not.
        now_ns: Simulation time since the start [ns]; `clock_ns` is that of the listeners' clock.
        bridge: Publishes the topics, spun by `executor`; `nodes` are those that it waits for.

    Raises:
        UsageError: The run is not valid.
    """

    def __init__(
        self,
        run: Run,
        artifacts: Path | None = None,
        frames: FrameOptions | None = None,
        *,
        listener: TrialListener | None = None,
        recording: Recording | None = None,
        cmd_vel: str = "late",
    ) -> None:
        run.check_single()
        check(run)
        super().__init__(artifacts)
        self.run, self._frames, self._cmd_vel = run, frames or FrameOptions(), cmd_vel
        self._listener, self._recording = listener or TrialListener(), recording
        self._evidence: Evidence | None = None
        self.truth = Truth()
        self.domain = 0
        self._pending = Tick(0, ()), Tick(0, ())  # of the episode, and what listeners get of it
        self.now_ns = self.clock_ns = 0
        self.speed = 0.0
        self.failure: str | None = None

    def __enter__(self) -> Self:
        if rclpy.ok():
            raise UsageError(
                "rclpy is initialised already; a trial does that in its own domain; leave it out"
            )
        with ExitStack() as at_end:
            self._at_end = at_end  # what is started meanwhile ends with it
            self._start(at_end)
            self._at_end = at_end.pop_all()
        return self

    def keep(self, folder: Path, reason: str) -> tuple[Path, ...]:
        """Ends the recording, puts it and a page about the last episode into a folder."""
        assert self._evidence is not None  # noqa: S101 - as `keep_evidence` makes sure
        assert self._recording is not None  # noqa: S101
        return self._evidence.keep(folder, reason, self._recording)

    def _start(self, at_end: ExitStack) -> None:
        stay_local()
        self.domain = at_end.enter_context(reserved_domain())
        self._programs = at_end.enter_context(Programs(self.domain, self._when))
        self._listener.begin_programs(self._programs)
        self._episode = Episode(self.run, frame_options=self._frames)
        self.info = self._episode.info
        no_handlers, args = SignalHandlerOptions.NO, list(ON_SIMULATED_TIME)
        rclpy.init(args=args, domain_id=self.domain, signal_handler_options=no_handlers)
        at_end.callback(rclpy.try_shutdown)
        at_end.enter_context(unfinished_is_freed())
        self._rover = rover = RoverNodes(self.run, 0, self._command, at_end, cmd_vel=self._cmd_vel)
        self.bridge, jumps = rover.bridge, rover.faults.disturbs_time
        self._ticks = drive_loop(self._batches(), (Route(rover.faults, self._take_tick, (self,)),))
        if self.artifacts is not None:
            self._recording = self._recording or Recording()
            self._evidence, self._has_evidence = Evidence(self.bridge, self.run, self.info), True
        if self._recording is not None:
            at_end.enter_context(self._recording).tap(self.bridge)
        if self._episode.description is not None:
            self.bridge.describe(self._episode.description)
        self.bridge.set_parameters([Parameter("use_sim_time", value=False)])  # it makes the time
        executor = make_executor(rclpy.get_default_context(), time_jumps=jumps)
        self.executor = at_end.enter_context(executor)
        self.executor.add_node(self.bridge)
        self.nodes = Nodes(self.bridge, self.executor, self._programs, time_jumps=jumps)

    @property
    def episode(self) -> Episode:
        """The present episode."""
        return self._episode

    @property
    def time(self) -> float:
        """Simulated seconds since the start, whatever faults do to /clock."""
        return self.now_ns / NANOSECONDS

    def host(self, make_node: Callable[[], Node]) -> Node:
        """Makes a node, which must not choose a context, and spins it here, on simulated time."""
        node: Any = make_node()
        self._at_end.callback(node.destroy_node)
        self.executor.add_node(node)
        self.join(node.get_fully_qualified_name(), node)
        return node  # type: ignore[no-any-return]  # rclpy has no types for mypy

    def launch(self, command: Sequence[str], node: str) -> None:
        """Starts a node in a process of its own, in any language, and waits until it is there.

        Args:
            command: Its words; `--ros-args -p use_sim_time:=true` belongs among them.
            node: Fully qualified name of the node, e.g. "/emergency_stop".

        Raises:
            RunFailed: The program ended at once.
            UsageError: There is no such program or node, or it runs on wall time.
        """
        self._programs.begin(command)
        self.nodes.wait_until(lambda: node in self.nodes.names())
        self.join(node)

    def join(self, name: str, node: object = None) -> None:
        """Keeps a node that runs already in step from now on.

        Args:
            name: Its fully qualified name.
            node: The rclpy node if it is hosted here.

        Raises:
            RunFailed: A program has ended and may not.
            UsageError: There is no such node, or it runs on wall time.
        """
        self.nodes.add(name, node)
        if node is None:  # another process's answer does not prove that its publishers are known
            spin_until_quiet(self.executor, self._publishers, QUIET, DISCOVERY_PATIENCE)
        is_anew = self._hears_anew(self.bridge.commands.look_around)
        if self._listener.joined() or is_anew:
            self.nodes.renew()

    def _hears_anew(self, look: Callable[[], bool]) -> bool:
        """Whether commands of another type are heard once a look has found any."""
        before = self.bridge.commands.heard
        spin_until(self.executor, look, DISCOVERY_PATIENCE)
        return self.bridge.commands.heard != before

    def _publishers(self) -> list[tuple[str, int]]:
        """How many publishers each topic is known to have."""
        bridge = self.bridge
        return [(t, bridge.count_publishers(t)) for t, _ in bridge.get_topic_names_and_types()]

    def _when(self) -> str:
        return f" at {self.time:g} s" if self.now_ns else " at its start"

    def collect(
        self, message_type: type[Message], topic: str, qos: QoSProfile | int = ANYTHING, most: int = MOST
    ) -> Heard[Message]:
        """Listens to a topic from now on; returns what is heard.

        Args:
            message_type: Of the topic.
            topic: Its name.
            qos: Of the subscription.
            most: How many messages are kept, the latest ones; all are counted.
        """
        heard: Heard[Message] = Heard(self.bridge.resolve_topic_name(topic), most)

        def take(message: Message) -> None:
            heard.take(message, self.time)

        self.bridge.create_subscription(message_type, topic, take, qos)
        self.nodes.renew()
        return heard

    def drive(self, linear: float, angular: float = 0.0) -> None:
        """Commands a speed [m/s] and a yaw rate [rad/s] until the next; for driver "cmd_vel" only."""
        if self.run.rover.driver != "cmd_vel":
            raise UsageError(f'driver "{self.run.rover.driver}" drives by itself; choose "cmd_vel"')
        self._command(Twist(linear, angular))

    def reset(self, *, seed: int | None = None, start: Start | None = None) -> None:
        """Puts the rover back to its start, at the end of the present control period of 50 ms.

        Time goes on. It drives again as it did at first; with driver "cmd_vel" it stands. With a seed or
        a start another episode begins, as that of a new trial would: its world, its noise, its whole
        duration, odometry and `truth` from 0. Nodes, /clock and the times of faults go on.

        Args:
            seed: Of the new episode; that of the last one if None.
            start: Where it starts: x, y [m] and yaw [rad] in the world; as before if None.

        Raises:
            UsageError: One of them is not valid; the present episode goes on.
        """
        if seed is None and start is None:
            self._episode.reset()
            return
        run = self.run.alone(
            seed=self.run.seed if seed is None else seed, start=start or self.run.rover.start
        )
        self._episode = Episode(run, frame_options=self._frames)
        self.run = run

    def step(self, seconds: float) -> None:
        """Lets simulated time go on; returns when every node has handled everything up to then.

        Raises:
            RunFailed: A node stopped answering, or the rover left the map.
            UsageError: The episode is over.
        """
        for _ in range(round(seconds * NANOSECONDS) // TICK_NS):
            self._go_on()

    def pause(self, seconds: float) -> None:
        """Lets time stand still: for so many simulated seconds /clock tells its last time again.

        That is every 10 ms of them; no sensor publishes, the rover stands, and `time` does not go on.
        Nodes handle each as they do all else.
        """
        tick, sent = self._pending
        still = replace(tick, samples=()), replace(sent, samples=())
        for _ in range(round(seconds * NANOSECONDS) // TICK_NS):
            self.bridge.advance(*still, listeners=self.nodes.subjects)

    def until(self, condition: Callable[[], bool], *, within: float) -> float:
        """Steps until a condition holds; gives the simulated seconds that this took.

        Raises:
            AssertionError: It does not hold after `within` simulated seconds.
        """
        began_ns = self.now_ns
        while not condition():
            if (self.now_ns - began_ns) / NANOSECONDS >= within:
                raise AssertionError(f"the condition did not hold within {within:g} simulated seconds")
            self._go_on()
        return (self.now_ns - began_ns) / NANOSECONDS

    def _go_on(self) -> None:
        if not self.advance():
            raise UsageError(f"the episode is over after {self.time:g} s; give a longer duration")

    def advance(self) -> bool:
        """Publishes the next tick of 10 ms; returns whether there was one.

        Raises:
            RunFailed: A node stopped answering, or the drive itself has failed: see `failure`.
        """
        commands = self.bridge.commands
        if commands.is_late and self._hears_anew(commands.begin):
            self.nodes.renew()
        self._listener.before_tick()
        if next(self._ticks, None) is None:
            return False
        self._programs.check()
        # Not in the loop, which what a node raises here would end for good.
        self.bridge.advance(*self._pending, listeners=self.nodes.subjects)
        if self.now_ns % LOOK_PERIOD_NS == 0:
            commands.look_around()
        self._listener.after_tick()
        return True

    def _take_tick(self, tick: Tick, sent: Tick) -> None:
        self._pending = tick, sent
        self.now_ns, self.clock_ns = tick.stamp_ns, sent.stamp_ns
        if (truth := tick.of(GroundTruth)) is not None:
            self.speed = truth.linear_velocity[0]
        self._listener.tick(tick, sent)

    def take(self, batch: Batch) -> None:
        """Takes account of a batch whose ticks have been published; what `drive_loop` calls."""
        self._listener.take(batch)
        if self._evidence is not None:
            self._evidence.take(batch)

    def _command(self, twist: Twist) -> None:
        self._episode.command(twist)

    def _batches(self) -> Generator[tuple[Batch]]:
        """The batches of one episode after the other, on one time."""
        episode, began_ns = self._episode, 0
        batches = episode.batches()
        while (batch := self._next(batches)) is not None:
            self.truth = batch.truth
            yield (later(batch, began_ns),)
            if episode is not self._episode:
                episode, began_ns = self._episode, self.now_ns
                batches, self.info = episode.batches(), episode.info
                self._rover.begin_anew(self.run)
                if self._evidence is not None:
                    self._evidence = Evidence(self.bridge, self.run, self.info)

    def _next(self, batches: Iterator[Batch]) -> Batch | None:
        try:
            return next(batches, None)
        except RunFailed as error:
            self.failure = str(error)
            raise
