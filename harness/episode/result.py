"""What a run comes to: counts, rows, truth and outcome, as plain values for table and manifest."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from harness.base.errors import how_many
from harness.base.interrupt import StopRequest
from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.helm import Helm
from harness.episode.loop import Observer
from harness.episode.mission import mission_of
from harness.episode.truth_account import TruthAccount, TruthAlong
from harness.samples import Truth
from harness.spec.ros import RosOptions
from harness.spec.rover import CMD_VEL, RoverSetup
from harness.spec.run import Run
from rover_metrics.core.columns import Row
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, Thresholds
from rover_metrics.extended.settings import Settings

SHOWN_EVERY = 0.05  # [s] of wall time: nobody sees more, and a whole result has its cost


@dataclass(frozen=True, slots=True)
class TopicCount:
    """Messages of one topic.

    Attributes:
        published: How many the harness sent.
        received: How many the metrics node's callbacks have handled; None where it does not listen.
        lost: How many were given up.
    """

    published: int
    received: int | None = None
    lost: int = 0


@dataclass(slots=True)
class CommandCount:
    """Commands on /cmd_vel.

    Attributes:
        taken: How many the rover was given.
        older: How many of these were stamped before the time that /clock had shown.
        refused: How many were not finite, or in a frame that is not the rover's.
    """

    taken: int = 0
    older: int = 0
    refused: int = 0


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """Everything the summary and the manifest say of one rover's part of a run.

    Attributes:
        number: The rover's place in the run.
        wall_s: Wall time from the first batch on [s], without the time in which it was paused.
        paused_s: That time [s].
        command: The line that repeats the run; "" where it was not begun by one, or was steered.
        failure: Why the run did not come to its end; None if it did or was interrupted.
        interrupted: The signal's name if somebody stopped it.
        commands: Those of /cmd_vel.
        refusal: The first of them that was refused, and why; "" if none was.
        waited_s: Wall time for which the run stood still for a node in lock-step, by its name [s].
        log_path: The metrics CSV; None without one.
        thresholds: Those that the metrics had at the end.
        along: What the rover met on its way, as the simulator knows it.
        reception: The metrics node's own account of each topic; None without one.
        segments: How often its time began anew, plus one; None without one.
        recording: The MCAP file; None without one.
        report: The page that was asked for; None if none was.
        params: The parameter file of the metrics that was given; None without.
        columns: Plug-ins that add columns to the log.
        social_log: The log of how near people were; None without people.
    """

    run: Run
    number: int = 0
    mode: str
    info: EpisodeInfo | None = None
    truth: Truth = field(default_factory=Truth)
    wall_s: float = 0.0
    paused_s: float = 0.0
    command: str = ""
    first_row_s: float | None = None
    failure: str | None = None
    interrupted: str | None = None
    topics: dict[str, TopicCount] = field(default_factory=dict)
    commands: CommandCount = field(default_factory=CommandCount)
    refusal: str = ""
    waited_s: dict[str, float] = field(default_factory=dict)
    rows: int = 0
    log_path: Path | None = None
    last_row: dict[str, int | float | str] | None = None
    thresholds: Thresholds = DEFAULT_THRESHOLDS
    along: TruthAlong = field(default_factory=TruthAlong)
    reception: dict[str, Any] | None = None
    segments: int | None = None
    recording: Path | None = None
    report: Path | None = None
    params: Path | None = None
    columns: tuple[str, ...] = ()
    social_log: Path | None = None

    @property
    def rover(self) -> RoverSetup:
        """The rover's setup."""
        return self.run.rovers[self.number]

    @property
    def simulated_s(self) -> float:
        """Simulated time [s]."""
        return self.truth.time_ns / NANOSECONDS

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per wall second."""
        return self.simulated_s / self.wall_s if self.wall_s > 0 else 0.0

    @property
    def mean_speed(self) -> float:
        """True path over time [m/s]."""
        return self.truth.path_length / self.simulated_s if self.simulated_s else 0.0

    @property
    def lost(self) -> int:
        """Messages lost over all topics."""
        return sum(count.lost for count in self.topics.values())

    @property
    def unheeded(self) -> str:
        """Which commands on /cmd_vel the rover did not follow, and why, in a line; "" if all or none."""
        count, driver = self.commands, self.rover.driver
        if count.refused:
            share = f"{count.refused:,} of {how_many(count.taken + count.refused, 'command')}"
            return (
                f"{share} {'was' if count.refused == 1 else 'were'} ignored; the first: {self.refusal}"
            )
        if count.taken and CMD_VEL not in (driver, *(name for _, name in self.run.plan.drivers)):
            heard = f"{how_many(count.taken, 'command')} on /cmd_vel"
            return f"{heard} moved nothing: driver '{driver}' makes its own; give driver '{CMD_VEL}'"
        return ""

    @property
    def messages(self) -> int:
        """Messages published over all topics."""
        return sum(count.published for count in self.topics.values())


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """Where the data of one rover go: the log into a folder, every batch to its observers."""

    log_dir: Path
    observers: Sequence[Observer] = ()
    settings: Settings = field(default_factory=Settings)


Show = Callable[[RunResult], None]
# run_direct, or run_through_ros: returns what each rover's part came to.
Drive = Callable[
    [Run, Sequence[Outputs], RosOptions, StopRequest, Show | None, Helm | None], tuple[RunResult, ...]
]


def cells_of(row: Row | None) -> dict[str, int | float | str] | None:
    """Returns the cells of a row by column name."""
    return None if row is None else dict(zip(row.columns, row.as_fields(), strict=True))


def steered(result: RunResult, helm: Helm | None) -> RunResult:
    """Returns the result of the run as it was driven: with what a helm has ordered underway, if any."""
    if helm is None:
        return result
    return replace(result, run=helm.driven(result.run), mode=f"{result.mode}{helm.note(result.run)}")


@dataclass
class RunAccount:
    """An observer that keeps account of a run and shows it.

    Args:
        begun: What is known before the first batch.
        started: Wall time at which the command began [s], of time.monotonic.
        show: Called with the result up to now, at most once in SHOWN_EVERY of wall time.
        topics: Counts the messages so far; `rows` counts those of the CSV.
        paused_s: Wall time for which the run was paused so far [s].
    """

    begun: RunResult
    started: float
    show: Show | None
    topics: Callable[[], dict[str, TopicCount]]
    rows: Callable[[], int]
    paused_s: Callable[[], float] = float

    def __post_init__(self) -> None:
        self._truth, self._total = TruthAccount(mission_of(self.begun.run)), self.begun.truth
        self._began = self._now = time.monotonic()
        self._held_s, self._shown = 0.0, self._now
        self._first_row_s: float | None = None

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        self._truth.take(batch)
        self._total, self._now, self._held_s = batch.truth, time.monotonic(), self.paused_s()
        if self._first_row_s is None and self.rows():
            self._first_row_s = self._now - self.started
        if self.show is not None and self._now - self._shown >= SHOWN_EVERY:
            self._shown = self._now
            self.show(self._so_far())

    def ended(self, *, failure: str | None = None, interrupted: str | None = None) -> RunResult:
        """Returns the result of the whole run, with what it met and why it ended early, if it did."""
        along = self._truth.along()
        if self.show is not None and self._shown < self._now:
            self.show(self._so_far())
        return replace(self._so_far(), along=along, failure=failure, interrupted=interrupted)

    def _so_far(self) -> RunResult:
        return replace(
            self.begun,
            truth=self._total,
            wall_s=self._now - self._began - self._held_s,
            paused_s=self._held_s,
            first_row_s=self._first_row_s,
            topics=self.topics(),
            rows=self.rows(),
        )
