"""One run of a scenario: driven, judged, and what came of it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.config import RosOptions
from harness.episode.direct import run_direct
from harness.episode.result import RunResult
from harness.errors import HarnessError
from harness.interrupt import StopRequest
from harness.report.log import read_log
from harness.scenario.case import Case
from harness.scenario.judge import Breach, judge
from harness.scenario.quantities import LOG, QUANTITIES, RUN, Series, TruthSeries
from harness.sim_time import NANOSECONDS
from rover_metrics.core.row import COLUMNS

_CORNERS = {
    "FL": "front left",
    "FR": "front right",
    "RL": "rear left",
    "RR": "rear right",
    "L": "left",
    "R": "right",
}


@dataclass(frozen=True)
class Attempt:
    """What a run of a scenario came to.

    Attributes:
        case: The run.
        breaches: What was not as expected, in the order of the file.
        error: Why it could not be run; None if it could.
        simulated_s: Simulated time [s]; likewise `wall_s`.
        model_hash: Of the rover's model; likewise `terrain_hash`.
    """

    case: Case
    breaches: tuple[str, ...] = ()
    error: str | None = None
    simulated_s: float = 0.0
    wall_s: float = 0.0
    model_hash: str = ""
    terrain_hash: str = ""

    @property
    def passed(self) -> bool:
        """Whether all was as expected."""
        return not self.breaches and self.error is None


def attempt(case: Case, folder: Path) -> Attempt:
    """Drives and judges a run.

    Args:
        case: The run.
        folder: For its log; it is created.
    """
    names = case.scenario.expect
    goal = case.scenario.goal
    watch = TruthSeries(
        [name for name in names if name in QUANTITIES], None if goal is None else (*goal.at, goal.radius)
    )
    extended = any(name.startswith(LOG) and name.removeprefix(LOG) not in COLUMNS for name in names)
    try:
        result = run_direct(
            case.config, RosOptions(log_dir=folder), StopRequest(), None, (watch,), extended=extended
        )
    except HarnessError as error:
        return Attempt(case, error=str(error))
    series = watch.series() | _logged(result) | _of_the_run(result)
    breaches = [] if result.failure is None else [f"run: {result.failure}"]
    for name, bound in case.scenario.bounds:
        breach = judge(name, bound, series[name])
        if breach is not None:
            breaches.append(breach.reason + _contact(name, breach, result))
    info = result.info
    return Attempt(
        case,
        tuple(breaches),
        None,
        result.simulated_s,
        result.wall_s,
        info.model_hash if info else "",
        info.terrain_hash if info else "",
    )


def _logged(result: RunResult) -> dict[str, Series]:
    """The columns of the log, by the names of their quantities."""
    log = read_log(result.log_path)
    times = np.array(log.time_s)
    return {f"{LOG}{name}": Series(times, np.array(values)) for name, values in log.columns.items()}


def _of_the_run(result: RunResult) -> dict[str, Series]:
    end = np.array([result.simulated_s])
    values = (result.lost, result.rows)
    return {name: Series(end, np.array([float(v)])) for name, v in zip(RUN, values, strict=True)}


def _contact(name: str, breach: Breach, result: RunResult) -> str:
    """What touched what, if a quantity counts contacts: the first at the time of the breach."""
    kind = QUANTITIES[name].contact if name in QUANTITIES else None
    if kind is None or breach.time_s is None:
        return ""
    of_kind = [event for event in result.along.events if event.kind == kind]
    meant = [event for event in of_kind if event.end_ns / NANOSECONDS >= breach.time_s - 0.05]
    if not meant:
        return ""
    event = min(meant, key=lambda e: e.start_ns)
    return f": {_part(event.part)} against {event.other}"


def _part(name: str) -> str:
    """A part of a rover in words: "wheel_FL" is the front left wheel."""
    kind, _, corner = name.partition("_")
    return f"{_CORNERS[corner]} {kind}" if corner in _CORNERS else name
