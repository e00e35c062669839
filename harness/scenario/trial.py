"""A run of a scenario as a trial: its nodes are started, its topics heard, and Python may assert more.

    with ScenarioTrial.load("scenarios/kerb.scenario.yaml", robot="leo") as trial:
        node = trial.host(MyNode)
        assert trial.finish() == ()

Scenarios that start nodes or expect something of topics are driven in just this way by their command.
"""

import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from shutil import copytree
from tempfile import TemporaryDirectory
from typing import Any, Self

import rclpy
from rclpy.logging import LoggingSeverity

from harness.base.errors import RunFailed, UsageError
from harness.base.sim_time import LOOK_PERIOD_NS, NANOSECONDS
from harness.episode.batch import Batch
from harness.episode.direct import LoggedRun
from harness.episode.result import RunResult, TopicCount
from harness.ros.remote import counted_by
from harness.samples import Tick
from harness.scenario.arrivals import heard_series
from harness.scenario.case import SCRATCH, Case, plan
from harness.scenario.steps import PauseEvent
from harness.scenario.subscriptions import Subscriptions
from harness.scenario.verdict import Attempt
from harness.scenario.watch import Watch
from harness.testing.evidence import LeavesEvidence, Recording
from harness.testing.listener import TrialListener
from harness.testing.process import Programs
from harness.testing.subject import Subject
from harness.testing.trial import Start, Trial
from rover_metrics.errors import LogError

KEPT = 10.0  # [s] of the recording
RECORDING = "run.mcap"
OUTPUT, FILES = ".txt", "files"  # what programs say, and the folder that they may write into


class ScenarioTrial(LeavesEvidence, TrialListener):
    """A run of a scenario: a Trial whose drive is logged, watched and judged.

    What a Trial can do, it can: host, collect, drive, step, until, pause, time, truth, ...

    Args:
        case: The run.
        artifacts: Folder for log, manifest, page and the recording of its last 10 s, if an exception
            ends the trial; None for none.
        folder: For what it writes until then; a temporary one if None.
        compare: Whether it is compared with its baseline, if it has one.

    Attributes:
        result: The run itself, after `finish`.

    Raises:
        UsageError: There is no baseline of it.
    """

    def __init__(
        self,
        case: Case,
        artifacts: Path | None = None,
        *,
        folder: Path | None = None,
        compare: bool = True,
    ) -> None:
        super().__init__(artifacts)
        self.case, self._given = case, folder
        self._recording = Recording(RECORDING, KEPT)
        self._trial = Trial(case.run, listener=self, recording=self._recording)
        self._watch = Watch(case, compare=compare)
        self._pauses = [event for event in case.scenario.events if isinstance(event, PauseEvent)]
        self._pauses.sort(key=lambda event: event.at)
        self._findings: Attempt | None = None

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

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - whatever a Trial has
        return getattr(self.__dict__["_trial"], name)

    def __enter__(self) -> Self:
        with ExitStack() as at_end:
            scratch = self._given or at_end.enter_context(TemporaryDirectory(prefix=SCRATCH))
            self._folder = Path(scratch)
            self._files = self._folder / FILES
            self._files.mkdir()
            trial = at_end.enter_context(self._trial)
            trial.bridge.get_logger().set_level(LoggingSeverity.WARN)  # one of many runs
            scenario, hear = self.case.scenario, self._recording.hear
            self._topics = Subscriptions(trial.bridge, scenario, now=self._now, record=hear)
            for name in trial.nodes.awaited([launch.wait_for for launch in scenario.launch]):
                trial.join(name)
            if not trial.nodes.subjects:  # a node that answers after it was published has heard it
                trial.host(lambda: rclpy.create_node("scenario", enable_rosout=False))
            mode = f"ROS 2, lock-step with {', '.join(node.name for node in trial.nodes.subjects)}"
            begun = RunResult(run=self.case.run, mode=mode, info=trial.info)
            log = LoggedRun(begun, self._folder, self._watch.settings, started=time.monotonic())
            self._logged, self._has_evidence = at_end.enter_context(log), True
            self._at_end = at_end.pop_all()
        return self

    @property
    def findings(self) -> Attempt:
        """What the run came to, after `finish`."""
        assert self._findings is not None, "it has not finished"  # noqa: S101 - a call comes too early
        return self._findings

    def finish(self) -> tuple[str, ...]:
        """Drives to the end; returns what was not as the scenario expects, each in a line.

        Raises:
            HarnessError: It could not be run: a node does not answer, a program has ended.
        """
        try:
            while self._trial.advance():
                pass
        except RunFailed:
            if self._trial.failure is None:
                raise  # else the drive itself has ended early, which is judged
        self.result = self._ended(self._trial.nodes.subjects)
        topics, now_ns = self._topics, self._trial.now_ns
        heard = heard_series(self.case, topics.heard, topics.known, self._watch.path, now_ns)
        self._findings = self._watch.judged(self.result, heard)
        return self._findings.breaches

    def keep(self, folder: Path, reason: str) -> tuple[Path, ...]:
        """Puts log, manifest, page, recording and what programs have said into a folder, made anew."""
        result = self._ended() if self._findings is None else self.result
        more = [self._recording.end(), *sorted(self._folder.glob(f"*{OUTPUT}"))]
        kept = self._watch.keep(result, folder, reason, more)
        if any(self._files.iterdir()):
            kept = (*kept, copytree(self._files, folder / FILES))
        return kept

    def reset(self, *, seed: int | None = None, start: Start | None = None) -> None:
        """Puts the rover back to its start; UsageError with a seed or a start: a run is one episode."""
        if seed is not None or start is not None:
            raise UsageError("a scenario's run is one episode; load another for another seed or start")
        self._trial.reset()

    def begin_programs(self, programs: Programs) -> None:
        """Starts the commands of the scenario."""
        for number, launch in enumerate(self.case.scenario.launch, 1):
            programs.begin(
                launch.words(str(self._files)),
                self.case.path.parent,
                self._folder / f"launch_{number}{OUTPUT}",
                may_end=launch.wait_for == (),
            )

    def joined(self) -> bool:
        """Hears what a node publishes from its first message on."""
        return self._topics.look_around()

    def before_tick(self) -> None:
        """Pauses where the scenario does."""
        while self._pauses and self._trial.now_ns >= round(self._pauses[0].at * NANOSECONDS):
            self._trial.pause(self._pauses.pop(0).pause)

    def tick(self, tick: Tick, sent: Tick) -> None:
        """Logs a tick."""
        try:
            self._logged.advance(tick, sent)
        except LogError as error:
            raise RunFailed(str(error)) from error

    def after_tick(self) -> None:
        """Hears topics that have turned up."""
        if self._trial.now_ns % LOOK_PERIOD_NS == 0 and self._topics.look_around():
            self._trial.nodes.renew()

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        self._watch.take(batch)
        self._logged.take(batch)

    def _now(self) -> tuple[int, int]:
        return self._trial.now_ns, self._trial.clock_ns

    def _ended(self, nodes: Sequence[Subject] = ()) -> RunResult:
        """What the run has come to, with what the nodes say that they have received."""
        result, commands = self._logged.ended(self._trial.failure), self._trial.bridge.commands
        published = {
            topic: replace(result.topics.get(topic, TopicCount(0)), published=count)
            for topic, count in self._trial.bridge.published().items()
        }
        return replace(
            result,
            topics=counted_by(nodes, published),
            commands=commands.count,
            refusal=commands.refusal,
            waited_s={subject.name: subject.waited_s for subject in self._trial.nodes.subjects},
        )
