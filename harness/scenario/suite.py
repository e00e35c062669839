"""Runs of scenarios to attempts, on one process or many; a suite that was stopped goes on."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from harness.base.interrupt import Interrupted
from harness.base.workers import Show, Workers, work_off
from harness.scenario.attempt import DEFAULTS, AttemptOptions, attempt
from harness.scenario.case import SCRATCH, Case
from harness.scenario.progress import Progress
from harness.scenario.verdict import Attempt

KEPT = "the same command with --resume goes on with the rest"


def run_all(
    cases: Sequence[Case],
    workers: Workers,
    folder: Path,
    show: Show,
    options: AttemptOptions = DEFAULTS,
    *,
    resume: bool = False,
) -> list[Attempt]:
    """Runs all, and returns the attempts in the order of the cases.

    Args:
        cases: What to run.
        workers: Who runs them.
        folder: For what runs leave that do not pass.
        show: Called with how many are done, and of how many.
        options: How each is judged, shown and kept.
        resume: Whether to go on where the same suite was stopped.

    Raises:
        RunFailed: Workers died again and again.
        Interrupted: Somebody stopped the command.
    """
    progress = Progress(cases, folder, compare=options.compare)
    before = progress.read() if resume else {}
    done = {place: one for place, one in before.items() if one.kept or not options.keep}
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
        work = partial(_attempt, folder=folder, options=replace(options, scratch=Path(scratch)))
        try:
            work_off(left, work, workers, note, name=lambda index: cases[index].name, mend=KEPT)
        except Interrupted as error:
            kept = f"; {KEPT}" if progress.exists else ""
            error.args = (f"{error} after {len(done)} of {len(cases)} runs{kept}",)
            raise
    progress.end()
    return [done[index] for index in range(len(cases))]


def _attempt(case: Case, *, folder: Path, options: AttemptOptions) -> Attempt:
    return attempt(case, folder / case.folder, options)
