"""One run of a scenario: driven, judged, and what came of it."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from harness.base.errors import INSTALL_ROS, HarnessError, UsageError
from harness.base.interrupt import Interrupted, StopRequest
from harness.episode.direct import run_direct, run_unlogged
from harness.episode.result import Outputs
from harness.scenario.baseline import Recorded
from harness.scenario.case import Case
from harness.scenario.quantities import QUANTITIES
from harness.scenario.series import SAMPLES
from harness.scenario.watch import Findings, Measured, Watch
from harness.spec.ros import RosOptions

SCRATCH = "rover-scenario-"


@dataclass(frozen=True)
class Attempt:
    """What a run of a scenario came to.

    Attributes:
        case: The run.
        breaches: What was not as expected, in the order of the file.
        error: Why it could not be run; None if it could.
        simulated_s: Simulated time [s].
        wall_s: Wall time that it took [s].
        model_hash: Hash of the rover's model; "" if it could not run.
        terrain_hash: Hash of the terrain; "" if it could not run.
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
        folder: Gets log, manifest, page and recording of a run that does not pass.
        compare: Whether it is compared with its baseline, if it has one.
        scratch: Folder for its log while it is driven, removed by the caller; where it does not exist,
            as on another machine, the system's.
    """
    drive = _through_ros if case.scenario.needs_ros else _direct
    try:
        with TemporaryDirectory(
            prefix=SCRATCH, dir=scratch if scratch and scratch.is_dir() else None
        ) as own:
            return drive(case, folder, compare, Path(own))
    except Interrupted:
        raise
    except HarnessError as error:
        return Attempt(case, error=str(error))


def _direct(case: Case, folder: Path, compare: bool, own: Path) -> Attempt:
    if _is_of_truth(case):
        watch = Watch(case)
        result = run_unlogged(case.run, StopRequest(), SAMPLES, (watch.truth,))
        found = watch.judged(result, {})
        if not found.breaches:
            return _attempted(case, found, ())
        # What is left of a run that fails takes all sensors: the same drive once more.
    watch = Watch(case, compare=compare)
    outputs = Outputs(log_dir=own, observers=(watch,), settings=watch.settings)
    (result,) = run_direct(case.run, (outputs,), RosOptions(log_dir=own), StopRequest())
    found = watch.judged(result, {})
    kept = watch.keep(result, folder, found.breaches[0]) if found.breaches else ()
    return _attempted(case, found, kept)


def _is_of_truth(case: Case) -> bool:
    """Whether the truth alone can say that a run passes: that takes neither a log nor every sensor."""
    only_truth = all(name in QUANTITIES for name in case.scenario.expect)
    return only_truth and not case.scenario.has_baseline and case.expected_failure is None


def _through_ros(case: Case, folder: Path, compare: bool, own: Path) -> Attempt:
    try:  # only here: no other scenario needs ROS 2
        from harness.scenario.trial import ScenarioTrial  # noqa: PLC0415
    except ImportError as error:
        message = f"nodes and topics need ROS 2, which is not importable ({error}); {INSTALL_ROS}"
        raise UsageError(message) from error
    with ScenarioTrial(case, folder=own, compare=compare) as trial:
        try:
            trial.finish()
        except Interrupted:
            raise
        except HarnessError as error:
            return Attempt(case, error=str(error), kept=trial.keep(folder, str(error)))
        found = trial.findings
        return _attempted(case, found, trial.keep(folder, found.breaches[0]) if found.breaches else ())


def _attempted(case: Case, found: Findings, kept: tuple[Path, ...]) -> Attempt:
    info = found.result.info
    return Attempt(
        case,
        found.breaches,
        simulated_s=found.result.simulated_s,
        wall_s=found.result.wall_s,
        model_hash=info.model_hash if info else "",
        terrain_hash=info.terrain_hash if info else "",
        recorded=found.recorded,
        kept=kept,
        measured=found.measured,
    )
