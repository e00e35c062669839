"""One run of a scenario: driven and judged."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory

from harness.base.errors import INSTALL_ROS, HarnessError, UsageError
from harness.base.interrupt import Interrupted, StopRequest
from harness.episode.direct import run_direct, run_unlogged
from harness.episode.result import Outputs
from harness.scenario.case import SCRATCH, Case
from harness.scenario.quantities import quantity_of
from harness.scenario.series import SAMPLES
from harness.scenario.verdict import Attempt
from harness.scenario.watch import WORDS, Watch, clear
from harness.spec.live import NOWHERE, LiveOptions
from harness.spec.ros import RosOptions
from harness.view.live import watched


@dataclass(frozen=True, kw_only=True)
class AttemptOptions:
    """How runs are judged, shown and kept.

    Attributes:
        compare: Whether a run is compared with its baseline, if it has one.
        keep: Whether log, manifest and page of a run that passes are kept too.
        live: Where a run can be watched meanwhile.
        scratch: Folder for the logs of runs, removed by the caller; where it does not exist, as on
            another machine, the system's.
    """

    compare: bool = True
    keep: bool = False
    live: LiveOptions = NOWHERE
    scratch: Path | None = None


DEFAULTS = AttemptOptions()


def attempt(case: Case, folder: Path, options: AttemptOptions = DEFAULTS) -> Attempt:
    """Drives and judges a run.

    Args:
        case: The run.
        folder: Gets log, manifest, page and recording of a run that does not pass.
        options: How it is judged, shown and kept.
    """
    drive = _through_ros if case.scenario.needs_ros else _direct
    scratch = options.scratch if options.scratch and options.scratch.is_dir() else None
    with TemporaryDirectory(prefix=SCRATCH, dir=scratch) as own:
        try:
            done = drive(case, folder, options, Path(own))
        except Interrupted:
            raise
        except HarnessError as error:
            return _kept(Attempt(case, error=str(error)), lambda _: _words_kept(Path(own), folder))
    if done.passed and not done.kept:
        clear(folder)
    return done


def _direct(case: Case, folder: Path, options: AttemptOptions, own: Path) -> Attempt:
    live = options.live
    if _is_of_truth(case) and not options.keep and live.live is None:
        watch = Watch(case)
        judged = watch.judged(run_unlogged(case.run, StopRequest(), SAMPLES, (watch.truth,)), {})
        if judged.passed:
            return judged
        # What is left of a run that fails takes all sensors: the same drive once more.
    watch = Watch(case, compare=options.compare)
    stop, ros = StopRequest(), RosOptions(log_dir=own)
    with watched(case.run, live, live.rate, stop) as (helm, seen):
        outputs = Outputs(log_dir=own, observers=(watch, *seen), settings=watch.settings)
        (result,) = run_direct(case.run, (outputs,), ros, stop, None, helm)
    if helm is not None and (note := helm.note(case.run)):  # says that somebody steered
        return Attempt(case, error=note.removeprefix(", "))
    judged = watch.judged(result, {})
    if judged.passed and not options.keep:
        return judged
    return _kept(judged, partial(watch.keep, result, folder))


def _is_of_truth(case: Case) -> bool:
    """Whether the truth alone can say that a run passes: that takes neither a log nor every sensor."""
    only_truth = all(quantity_of(name) is not None for name in case.scenario.quantities)
    return only_truth and not case.scenario.has_baseline and case.expected_failure is None


def _through_ros(case: Case, folder: Path, options: AttemptOptions, own: Path) -> Attempt:
    if options.live.live is not None:
        raise UsageError("--live is not for scenarios with nodes or topics; leave it out")
    try:  # only here: no other scenario needs ROS 2
        from harness.scenario.trial import ScenarioTrial  # noqa: PLC0415
    except ImportError as error:
        message = f"nodes and topics need ROS 2, which is not importable ({error}); {INSTALL_ROS}"
        raise UsageError(message) from error
    with ScenarioTrial(case, folder=own, compare=options.compare) as trial:
        try:
            trial.finish()
        except Interrupted:
            raise
        except HarnessError as error:
            return _kept(Attempt(case, error=str(error)), partial(trial.keep, folder))
        judged = trial.findings
        if judged.passed and not options.keep:
            return judged
        return _kept(judged, partial(trial.keep, folder))


def _words_kept(own: Path, folder: Path) -> tuple[Path, ...]:
    """Keeps what the programs of a run have said that did not begin; returns where that is."""
    said = [file for file in sorted(own.glob(WORDS)) if file.stat().st_size]
    if said:  # else what an earlier run has left is all that there is
        clear(folder)
        folder.mkdir(parents=True, exist_ok=True)
    return tuple(Path(copy(file, folder)) for file in said)


def _kept(judged: Attempt, keep: Callable[[str], tuple[Path, ...]]) -> Attempt:
    """Adds what is left of a run; where that cannot be kept, one that did not pass says so too."""
    try:
        return replace(judged, kept=keep(judged.error or next(iter(judged.breaches), "")))
    except Interrupted:
        raise
    except (OSError, HarnessError) as error:
        if judged.passed:
            raise
        lost = f"its evidence could not be kept: {error}"
        if judged.error is not None:
            return replace(judged, error=f"{judged.error}\n{lost}")
        return replace(judged, breaches=(*judged.breaches, lost))
