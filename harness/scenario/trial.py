"""A run of a scenario as a trial: its nodes are started, its topics heard, and Python may assert more.

    with ScenarioTrial.load("scenarios/kerb.scenario.yaml", robot="leo") as trial:
        node = trial.host(MyNode)
        assert trial.finish() == ()

Scenarios that start nodes or expect something of topics are driven in just this way by their command.
"""

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from shutil import copytree
from tempfile import TemporaryDirectory
from typing import Self

import rclpy
from rclpy.logging import LoggingSeverity

from harness.base.errors import HarnessError, RunFailed, UsageError
from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.episode.direct import LoggedRun
from harness.episode.result import RunResult, TopicCount
from harness.ros.context import spin_until, spin_until_quiet
from harness.ros.remote import DISCOVERY_PATIENCE, counted_by
from harness.samples import Tick
from harness.scenario.arrivals import topic_series
from harness.scenario.case import Case
from harness.scenario.events import PauseEvent
from harness.scenario.evidence import keep_evidence
from harness.scenario.hearing import Hearing
from harness.scenario.selection import plan
from harness.scenario.series import Series
from harness.scenario.topic import TopicQuantity, topic_quantity
from harness.scenario.watch import Findings, Watch
from harness.testing.evidence import Recording
from harness.testing.nodes import START_PATIENCE
from harness.testing.subject import Subject
from harness.testing.trial import Start, Trial
from rover_metrics.errors import LogError

KEPT = 10.0  # [s] of the recording
RECORDING = "run.mcap"
OUTPUT, FILES = ".txt", "files"  # what programs say, and the folder that they may write into
QUIET = 0.2  # [s] of wall time in which nothing new is discovered, before a run begins
LOOK_NS = NANOSECONDS // 10  # of simulated time, between two looks for topics that have turned up
# Nodes that are no part of what a command is started for: of ros2's own tools.
TOOLS = ("_", "launch_ros_")


class ScenarioTrial(Trial):
    """A trial of one run of a scenario.

    Args:
        case: The run.
        artifacts: Folder for log, manifest, page and the recording of its last 10 s, if an exception
            ends the trial; None for none.
        folder: For what it writes until then; a temporary one if None.
        compare: Whether it is compared with its baseline, if it has one.

    Raises:
        UsageError: There is no baseline of it.
    """

    CMD_VEL = "auto_twist"  # hosted nodes send Twist, as to every trial; others what they like

    def __init__(
        self,
        case: Case,
        artifacts: Path | None = None,
        *,
        folder: Path | None = None,
        compare: bool = True,
    ) -> None:
        super().__init__(case.run, artifacts)
        self.case, self._given = case, folder
        self._watch = Watch(case, compare=compare)
        self._pauses = [event for event in case.scenario.events if isinstance(event, PauseEvent)]
        self._pauses.sort(key=lambda event: event.at)
        self._is_on = False
        self._failure: str | None = None
        self._findings: Findings | None = None

    @classmethod
    def load(
        cls, path: Path | str, artifacts: Path | None = None, *, seed: int | None = None, **cell: object
    ) -> Self:
        """Returns the trial of a run of a file.

        Args:
            path: The scenario.
            artifacts: As of the class.
            seed: Of the run; the first one of the file if None.
            cell: A value for each name of its matrix.

        Raises:
            UsageError: The file is not valid, or it has several runs of these values.
        """
        only = tuple((name, str(value)) for name, value in cell.items())
        cases = plan([Path(path)], None if seed is None else [seed], only)
        first = [case for case in cases if case.run.seed == cases[0].run.seed]
        if len(first) > 1:
            names = ", ".join(f"{name}={value!r}" for name, value in first[0].cell)
            raise UsageError(f"{path} has {len(first)} runs of a seed; choose one, e.g. {names}")
        return cls(first[0], artifacts)

    @property
    def findings(self) -> Findings:
        """What the run came to, after `finish`."""
        assert self._findings is not None, "it has not finished"  # noqa: S101 - for who calls it before
        return self._findings

    def finish(self) -> tuple[str, ...]:
        """Drives to the end; returns what was not as the scenario expects, each in a line.

        Raises:
            HarnessError: It could not be run: a node does not answer, a program has ended.
        """
        while self._advance():
            pass
        self._findings = self._watch.judged(self._ended(self._nodes.subjects), self._heard())
        return self._findings.breaches

    def keep(self, folder: Path, reason: str) -> tuple[Path, ...]:
        """Puts log, manifest, page, recording and what programs have said into a folder.

        Args:
            folder: Is made; one of an earlier run is replaced.
            reason: Why the run did not pass, for manifest and page.

        Returns:
            What it has put there, the page first.
        """
        result = self._ended() if self._findings is None else self._findings.result
        recording = self._recording.end()
        more = [] if recording is None else [recording]
        more += sorted(self._folder.glob(f"*{OUTPUT}"))
        kept = keep_evidence(result, self._watch.page, folder, reason, more)
        if any(self._files.iterdir()):
            kept = (*kept, copytree(self._files, folder / FILES))
        return kept

    def keep_evidence(self, reason: str) -> str:
        """See Trial."""
        folder, self.artifacts = self.artifacts, None
        if folder is None or not self._is_on:
            return ""
        try:
            kept = self.keep(folder, next(iter(reason.splitlines()), "an exception"))
        except (HarnessError, OSError) as error:
            return f"nothing could be kept of this trial: {error}"
        return "\n".join(f"kept: {path}" for path in kept)

    def reset(self, *, seed: int | None = None, start: Start | None = None) -> None:
        """Puts the rover back to its start; see Trial. A run of a scenario is one episode.

        Raises:
            UsageError: Another seed or start is asked for.
        """
        if seed is not None or start is not None:
            raise UsageError("a scenario's run is one episode; load another for another seed or start")
        super().reset()

    def take(self, batch: Batch) -> None:
        """See Trial."""
        self._watch.take(batch)
        self._logged.take(batch)

    def _begin_processes(self) -> None:
        given, at_end = self._given, self._at_end
        scratch = given or at_end.enter_context(TemporaryDirectory(prefix="rover-scenario-"))
        self._folder, self._files = Path(scratch), Path(scratch) / FILES
        self._files.mkdir()
        for number, launch in enumerate(self.case.scenario.launches, 1):
            self._begin(
                launch.words(str(self._files)),
                self.case.path.parent,
                self._folder / f"launch_{number}{OUTPUT}",
                may_end=launch.nodes == (),
            )

    def _record(self, at_end: ExitStack) -> None:
        self._recording = at_end.enter_context(Recording(self._bridge, RECORDING, KEPT))

    def _start(self, at_end: ExitStack) -> None:
        super()._start(at_end)
        self._bridge.get_logger().set_level(LoggingSeverity.WARN)  # one of many runs
        inputs = {bound.of for _, bound in self.case.scenario.bounds if bound.of is not None}
        hear, wanted = self._recording.hear, self._wanted()
        self._hearing = Hearing(self._bridge, wanted, inputs, now=self._now, record=hear)
        self._await_nodes()
        if not self._nodes.subjects:  # what is published is heard when somebody has answered after it
            self.host(lambda: rclpy.create_node("scenario", enable_rosout=False))
        mode = f"ROS 2, lock-step with {', '.join(subject.name for subject in self._nodes.subjects)}"
        begun = RunResult(run=self.run, mode=mode, info=self._episode.info)
        log = LoggedRun(begun, self._folder, self._watch.settings, started=time.monotonic())
        self._logged, self._is_on = at_end.enter_context(log), True

    def _await_nodes(self) -> None:
        """Waits for the nodes that are named, and for one of each command that names none."""
        launches = [launch.nodes for launch in self.case.scenario.launches]
        named = [name for nodes in launches for name in nodes or ()]
        others = launches.count(None)

        def unnamed() -> list[str]:
            found = sorted(self._nodes.names().difference(named))
            return [name for name in found if not name.rpartition("/")[2].startswith(TOOLS)]

        def missing() -> list[str]:
            absent = [name for name in named if name not in self._nodes.names()]
            return absent + ["a node"] * (others - len(unnamed()))

        self._nodes.wait_until(lambda: not missing())
        if missing():
            running = ", ".join(sorted(self._nodes.names())) or "none"
            patience = f"{missing()[0]} has not turned up within {START_PATIENCE:g} s"
            raise UsageError(f"launch: {patience}; running: {running}")
        for name in (*named, *unnamed()[:others]):
            self._keep_in_step(name)

    def _keep_in_step(self, name: str, node: object = None) -> None:
        """Hears what a node publishes from its first message on; see Trial."""
        super()._keep_in_step(name, node)
        if node is None:  # no answer of another process tells that all of its publishers are known here
            spin_until_quiet(self._executor, self._publishers, QUIET, DISCOVERY_PATIENCE)
        commands = self._bridge.commands
        before = commands.heard
        spin_until(self._executor, commands.look_around, DISCOVERY_PATIENCE)
        if self._hearing.look_around() or commands.heard != before:
            self._nodes.renew()

    def _publishers(self) -> list[tuple[str, int]]:
        """How many publishers each topic is known to have."""
        bridge = self._bridge
        return [(t, bridge.count_publishers(t)) for t, _ in bridge.get_topic_names_and_types()]

    def _wanted(self) -> dict[str, list[TopicQuantity]]:
        """What is expected of each topic."""
        wanted: dict[str, list[TopicQuantity]] = {}
        for name in self.case.scenario.expect:
            quantity = topic_quantity(name)
            if quantity is not None:
                wanted.setdefault(quantity.topic, []).append(quantity)
        return wanted

    def _now(self) -> tuple[int, int]:
        return self._now_ns, self._pending[1].stamp_ns

    def _advance(self) -> bool:
        while self._pauses and self._now_ns >= round(self._pauses[0].at * NANOSECONDS):
            self.pause(self._pauses.pop(0).pause)
        if not super()._advance():
            return False
        if self._now_ns % LOOK_NS == 0:
            self._bridge.commands.look_around()
            if self._hearing.look_around():
                self._nodes.renew()
        return True

    def _take(self, tick: Tick, sent: Tick) -> None:
        super()._take(tick, sent)
        try:
            self._logged.advance(tick, sent)
        except LogError as error:
            raise RunFailed(str(error)) from error

    def _batches(self) -> Iterator[tuple[Batch]]:
        """What the episode itself fails of ends the run, which is judged; see Trial."""
        try:
            yield from super()._batches()
        except RunFailed as error:
            self._failure = str(error)

    def _ended(self, nodes: Sequence[Subject] = ()) -> RunResult:
        """What the run has come to, with what the nodes say that they have received."""
        result = self._logged.ended(self._failure)
        published = {
            topic: replace(result.topics.get(topic, TopicCount(0)), published=count)
            for topic, count in self._bridge.published().items()
        }
        return replace(
            result,
            topics=counted_by(nodes, published),
            commands=self._bridge.commands.count,
            waited_s={subject.name: subject.waited_s for subject in self._nodes.subjects},
        )

    def _heard(self) -> dict[str, Series]:
        """The quantities of topics over time."""
        hearing, known = self._hearing, self._hearing.known
        pairs = [(name, topic_quantity(name), bound) for name, bound in self.case.scenario.bounds]
        return {
            bound.label(name): topic_series(quantity, bound.of, hearing.heard, known, self._now_ns)
            for name, quantity, bound in pairs
            if quantity is not None
        }
