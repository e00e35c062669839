"""One run of a scenario: driven, judged, and what came of it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from harness.config import RosOptions
from harness.episode.direct import run_direct, run_unlogged
from harness.episode.metrics_feed import extended_settings
from harness.episode.result import RunResult
from harness.errors import HarnessError
from harness.interrupt import Interrupted, StopRequest
from harness.report.log import read_log
from harness.report.recorder import RunRecorder
from harness.robots import find_rover
from harness.scenario.baseline import (
    Recorded,
    check_comparable,
    first_difference,
    key_of,
    read_baseline,
    record,
)
from harness.scenario.case import Case
from harness.scenario.contact import contact_of
from harness.scenario.evidence import keep_evidence
from harness.scenario.judge import judge, judge_against, value_of
from harness.scenario.quantities import LOG, QUANTITIES, RUN
from harness.scenario.series import SAMPLES, Series, TruthSeries
from rover_metrics.core.row import COLUMNS
from rover_metrics.extended.settings import Settings

SCRATCH = "rover-scenario-"


@dataclass(frozen=True)
class Measured:
    """What a quantity came to in a run: what its bound compares.

    Attributes:
        value: In `unit`; None where there was none.
        unit: Empty for counts, flags and columns of the log.
    """

    value: float | None
    unit: str = ""


@dataclass(frozen=True)
class Attempt:
    """What a run of a scenario came to.

    Attributes:
        case: The run.
        breaches: What was not as expected, in the order of the file.
        error: Why it could not be run; None if it could.
        simulated_s: Simulated time [s]; likewise `wall_s`.
        model_hash: Of the rover's model; likewise `terrain_hash`.
        recorded: What a baseline keeps of it; None if it has none.
        kept: What is left of a run that did not pass.
        measured: What each bound of the scenario compares, in their order; nothing if it could not run.
    """

    case: Case
    breaches: tuple[str, ...] = ()
    error: str | None = None
    simulated_s: float = 0.0
    wall_s: float = 0.0
    model_hash: str = ""
    terrain_hash: str = ""
    recorded: Recorded | None = None
    kept: tuple[Path, ...] = ()
    measured: tuple[Measured, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether all was as expected."""
        return not self.breaches and self.error is None


def attempt(case: Case, folder: Path, *, compare: bool = True, scratch: Path | None = None) -> Attempt:
    """Drives and judges a run.

    Args:
        case: The run.
        folder: Gets log, manifest and page of a run that does not pass.
        compare: Whether it is compared with its baseline, if it has one.
        scratch: Folder for its log while it is driven, removed by the caller; where it does not exist,
            as on another machine, the system's.
    """
    try:
        return _attempt(case, folder, compare, scratch if scratch and scratch.is_dir() else None)
    except Interrupted:
        raise
    except HarnessError as error:
        return Attempt(case, error=str(error))


def _attempt(case: Case, folder: Path, compare: bool, scratch: Path | None) -> Attempt:
    if _is_of_truth(case):
        quick = _watched(case)
        if quick.passed:
            return quick
        # What is left of a run that fails takes all sensors: the same drive once more.
    baseline = read_baseline(case) if case.scenario.has_baseline and compare else None
    watch, page = _watch(case), RunRecorder()
    with TemporaryDirectory(prefix=SCRATCH, dir=scratch) as own:
        options = RosOptions(log_dir=Path(own))
        result = run_direct(case.config, options, StopRequest(), None, (watch, page), _settings(case))
        series = watch.series() | _logged(result) | _of_the_run(result)
        recorded = record(case, result, series) if case.scenario.has_baseline else None
        if baseline is not None and recorded is not None:
            check_comparable(recorded, baseline)
        breaches = tuple(_breaches(case, result, series, recorded, baseline))
        kept = keep_evidence(result, page, folder, breaches[0]) if breaches else ()
    return replace(_told(case, result, breaches, series), recorded=recorded, kept=kept)


def _is_of_truth(case: Case) -> bool:
    """Whether the truth alone can say that a run passes: that takes neither a log nor every sensor."""
    only_truth = all(name in QUANTITIES for name in case.scenario.expect)
    return only_truth and not case.scenario.has_baseline and case.expected_failure is None


def _watched(case: Case) -> Attempt:
    """A run that nobody but the watch of its truth sees."""
    watch = _watch(case)
    result = run_unlogged(case.config, StopRequest(), SAMPLES, (watch,))
    series = watch.series()
    return _told(case, result, tuple(_breaches(case, result, series, None, None)), series)


def _told(
    case: Case, result: RunResult, breaches: tuple[str, ...], series: dict[str, Series]
) -> Attempt:
    info = result.info
    return Attempt(
        case,
        breaches,
        simulated_s=result.simulated_s,
        wall_s=result.wall_s,
        model_hash=info.model_hash if info else "",
        terrain_hash=info.terrain_hash if info else "",
        measured=tuple(
            Measured(value_of(bound, series[name]), "" if bound.share else series[name].unit)
            for name, bound in case.scenario.bounds
        ),
    )


def _watch(case: Case) -> TruthSeries:
    goal = case.scenario.goal
    names = [name for name in case.scenario.expect if name in QUANTITIES]
    return TruthSeries(names, None if goal is None else (*goal.at, goal.radius))


def _settings(case: Case) -> Settings:
    """With the extended columns where one is expected of."""
    columns = [name.removeprefix(LOG) for name in case.scenario.expect if name.startswith(LOG)]
    if set(columns) <= set(COLUMNS):
        return Settings()
    return Settings(extended_columns=True, extended=extended_settings(find_rover(case.config.robot)))


def _breaches(
    case: Case,
    result: RunResult,
    series: dict[str, Series],
    recorded: Recorded | None,
    baseline: Recorded | None,
) -> Iterator[str]:
    """What was not as expected, each in a line."""
    if result.failure is not None:
        yield f"run: {result.failure}"
    for name, bound in case.scenario.bounds:
        if not bound.has_baseline:
            breach = judge(name, bound, series[name])
        elif baseline is not None:
            breach = judge_against(name, bound, series[name], baseline.values.get(key_of(name, bound)))
        else:
            continue
        if breach is not None:
            yield breach.reason + contact_of(name, breach, result.along.events)
    if case.scenario.same_bytes and recorded is not None and baseline is not None:
        difference = first_difference(recorded, baseline)
        if difference is not None:
            yield difference


def _logged(result: RunResult) -> dict[str, Series]:
    """The columns of the log, by the names of their quantities."""
    log = read_log(result.log_path)
    times = np.array(log.time_s)
    return {f"{LOG}{name}": Series(times, np.array(values)) for name, values in log.columns.items()}


def _of_the_run(result: RunResult) -> dict[str, Series]:
    end = np.array([result.simulated_s])
    values = (result.lost, result.rows)
    return {name: Series(end, np.array([float(v)])) for name, v in zip(RUN, values, strict=True)}
