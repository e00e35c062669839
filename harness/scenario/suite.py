"""Runs of scenarios to attempts, on one process or many; a suite that was stopped goes on."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from harness.base.interrupt import Interrupted
from harness.scenario.attempt import SCRATCH, attempt
from harness.scenario.case import Case
from harness.scenario.progress import Progress
from harness.scenario.verdict import Attempt
from harness.spec.live import NOWHERE, LiveOptions
from harness.workers import Workers, work_off

KEPT = "the same command with --resume goes on with the rest"


def run_all(
    cases: Sequence[Case],
    workers: Workers,
    folder: Path,
    show: Callable[[int, int], None],
    *,
    compare: bool = True,
    resume: bool = False,
    keep: bool = False,
    live: LiveOptions = NOWHERE,
) -> list[Attempt]:
    """Runs all, and returns the attempts in the order of the cases.

    Args:
        cases: What to run.
        workers: Who runs them.
        folder: For what runs leave that do not pass.
        show: Told how many of how many are done.
        compare: Whether they are compared with their baselines.
        keep: Whether the logs of runs that pass are kept too.
        live: Where they can be watched, one after the other in this process.
        resume: Whether to go on where the same suite was stopped.

    Raises:
        RunFailed: Workers died again and again.
        Interrupted: Somebody stopped the command.
    """
    progress = Progress(cases, folder, compare=compare)
    done = progress.read() if resume else {}
    if not done:
        progress.begin()
    show(len(done), len(cases))

    def note(index: int, outcome: Attempt) -> None:
        progress.keep(index, outcome)
        done[index] = outcome
        show(len(done), len(cases))

    left = {index: case for index, case in enumerate(cases) if index not in done}
    # A worker that is killed leaves its files: they are below a folder of this process.
    with TemporaryDirectory(prefix=SCRATCH) as scratch:
        how: dict[str, Any] = {"compare": compare, "scratch": Path(scratch), "keep": keep, "live": live}
        work = partial(_attempt, folder=folder, **how)
        try:
            work_off(left, work, workers, note, name=lambda index: cases[index].name, mend=KEPT)
        except Interrupted as error:
            kept = f"; {KEPT}" if progress.exists else ""
            error.args = (f"{error} after {len(done)} of {len(cases)} runs{kept}",)
            raise
    progress.end()
    return [done[index] for index in range(len(cases))]


def _attempt(case: Case, *, folder: Path, **how: Any) -> Attempt:  # noqa: ANN401 - as of `attempt`
    return attempt(case, folder / case.folder, **how)
