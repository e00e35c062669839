"""Watches a run of a scenario and judges it: what was not as expected."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from shutil import rmtree

import numpy as np

from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.episode.metrics_feed import metric_settings
from harness.episode.mission import MissionOutcome, mission_of, without
from harness.episode.result import RunResult
from harness.page.run.evidence import keep_evidence
from harness.page.run.log import read_log
from harness.page.run.recorder import RunRecorder
from harness.samples import ContactEvent
from harness.scenario.baseline import (
    Recorded,
    check_comparable,
    first_difference,
    key_of,
    read_baseline,
    record,
)
from harness.scenario.case import Case
from harness.scenario.judge import Breach, judge, judge_against, value_of
from harness.scenario.poses import TruePath
from harness.scenario.quantities import LOG, ROUTE, RUN, SAMPLED, TARGETS, quantity_of
from harness.scenario.series import Series, TruthSeries
from harness.scenario.verdict import Attempt, Measured
from rover_metrics.core.columns import COLUMNS, ROBOTERRAIN_COLUMNS
from rover_metrics.extended.settings import Settings
from rover_metrics.sheet.sheet import spelled

PAGE = "run.html"
ALL_TARGETS = f"{TARGETS[0]}s"  # how the name of the quantity begins that counts them
WORDS = "launch_*.txt"  # what its programs have said
_SIDES = {"L": "left", "R": "right"}
_CORNERS = _SIDES | {"FL": "front left", "FR": "front right", "RL": "rear left", "RR": "rear right"}


def clear(folder: Path) -> None:
    """Removes what an earlier run has left in its folder, if that is one of a run."""
    if (folder / PAGE).exists() or any(folder.glob(WORDS)):
        rmtree(folder)


class Watch:
    """Watches a run, an Observer, and judges it.

    Args:
        case: The run.
        compare: Whether it is compared with its baseline, if it has one.

    Attributes:
        truth: Its quantities of the truth; an Observer of its own.
        page: What a page shows of it.
        path: Its true poses.

    Raises:
        UsageError: There is no baseline of it.
    """

    def __init__(self, case: Case, *, compare: bool = True) -> None:
        self._case, goal = case, case.scenario.goal
        self._baseline = read_baseline(case) if case.scenario.has_baseline and compare else None
        names = [name for name in case.scenario.quantities if quantity_of(name) is not None]
        is_mission = any(name.startswith((ROUTE, *TARGETS)) for name in names)
        mission = mission_of(case.run) if is_mission else None
        self.truth = TruthSeries(names, None if goal is None else (*goal.at, goal.radius), mission)
        self.page, self.path = RunRecorder(), TruePath()

    @property
    def settings(self) -> Settings:
        """What the log is to hold: the extended columns where one is expected of, by the parameters."""
        logged = (name for name in self._case.scenario.quantities if name.startswith(LOG))
        extended = not {name.removeprefix(LOG) for name in logged} <= set(COLUMNS)
        return metric_settings(self._case.run, self._case.params, extended=extended)

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        self.truth.take(batch)
        self.page.take(batch)
        self.path.take(batch)

    def judged(self, result: RunResult, heard: Mapping[str, Series]) -> Attempt:
        """Returns what a run with these quantities of topics came to, by its log too.

        Raises:
            UsageError: Its baseline is of another version, model, terrain or argument.
        """
        series = {**self.truth.series(), **_logged(result), **_of_the_run(result), **heard}
        has_baseline = self._case.scenario.has_baseline
        recorded = record(self._case, result, series) if has_baseline else None
        if self._baseline is not None and recorded is not None:
            check_comparable(recorded, self._baseline)
        measured = (
            Measured(value_of(bound, one), "" if bound.share else one.unit)
            for name, bound in self._case.scenario.measured
            for one in [series[bound.label(name)]]
        )
        breaches, unheeded = tuple(self._breaches(result, series, recorded)), result.unheeded
        return Attempt(
            self._case,
            (*breaches, unheeded) if breaches and unheeded else breaches,
            simulated_s=result.simulated_s,
            wall_s=result.wall_s,
            model_hash=result.info.model_hash if result.info else "",
            terrain_hash=result.info.terrain_hash if result.info else "",
            recorded=recorded,
            measured=tuple(measured),
            unheeded=unheeded,
        )

    def keep(
        self, result: RunResult, folder: Path, reason: str, more: Iterable[Path | None] = ()
    ) -> tuple[Path, ...]:
        """Puts log, manifest and page of the run into a folder of its own; returns their places.

        Args:
            result: What the run came to.
            folder: Is made; what an earlier run has left in it goes.
            reason: Why the run did not pass; "" if it did.
            more: Other files to copy there.
        """
        clear(folder)
        repeatable = replace(result, command=self._case.command)
        return keep_evidence(repeatable, self.page, folder / PAGE, reason, more)

    def _breaches(
        self, result: RunResult, series: Mapping[str, Series], recorded: Recorded | None
    ) -> Iterator[str]:
        """What was not as expected, each in a line."""
        if result.failure is not None:
            yield f"run: {result.failure}"
        baseline = self._baseline
        for name, bound in self._case.scenario.bounds:
            label = bound.label(name)
            if not bound.has_baseline:
                breach = judge(label, bound, series[label])
            elif baseline is not None:
                known = baseline.values.get(key_of(name, bound))
                breach = judge_against(label, bound, series[label], known)
            else:
                continue
            if breach is not None:
                missed = missed_of(name, result.along.mission)
                yield breach.reason + contact_of(name, breach, result.along.events) + missed
        if self._case.scenario.same_bytes and recorded is not None and baseline is not None:
            difference = first_difference(recorded, baseline)
            if difference is not None:
                yield difference


def missed_of(name: str, mission: MissionOutcome | None) -> str:
    """Returns e.g. ", not (3, 4)": which way points or targets a quantity of that name has missed."""
    if mission is None or not name.startswith((ROUTE, ALL_TARGETS)):
        return ""
    return without(mission.way_points if name.startswith(ROUTE) else mission.targets)


def contact_of(name: str, breach: Breach, events: Sequence[ContactEvent]) -> str:
    """Returns e.g. ": front left wheel against hazard_3"; nothing if there is nothing to tell.

    Args:
        name: Of the quantity.
        breach: What is wrong with it, and since when.
        events: All contacts of the run; those of one kind do not overlap.
    """
    quantity = quantity_of(name)
    kind = None if quantity is None else quantity.contact
    if kind is None or breach.time_s is None:
        return ""
    since = breach.time_s - SAMPLED
    meant = [e for e in events if e.kind == kind and e.end_ns / NANOSECONDS >= since]
    if not meant:
        return ""
    event = min(meant, key=lambda e: e.start_ns)
    part, _, corner = event.part.partition("_")  # of wheel_FL
    words = f"{_CORNERS[corner]} {part}" if corner in _CORNERS else event.part
    return f": {words} against {event.other}"


def _logged(result: RunResult) -> dict[str, Series]:
    """The columns of the log, by the names of their quantities."""
    log = read_log(result.log_path)
    times = np.array(log.time_s)
    units = {column.name: spelled(column.unit) for column in ROBOTERRAIN_COLUMNS}
    return {
        f"{LOG}{name}": Series(times, np.array(values), units.get(name, ""))
        for name, values in log.columns.items()
    }


def _of_the_run(result: RunResult) -> dict[str, Series]:
    end = np.array([result.simulated_s])
    values = (result.lost, result.rows, result.commands.refused)
    return {name: Series(end, np.array([float(v)])) for name, v in zip(RUN, values, strict=True)}
