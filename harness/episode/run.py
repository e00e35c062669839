"""A run from Python: a value in, a CSV and what the run came to out."""

from collections.abc import Sequence
from pathlib import Path

from harness.base.interrupt import StopRequest
from harness.episode.direct import run_direct
from harness.episode.loop import Observer
from harness.episode.manifest import write_manifest
from harness.episode.result import Outputs, RunResult
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from rover_metrics.extended.settings import Settings


def run_episode(
    run: Run,
    log_dir: Path | str,
    *,
    observers: Sequence[Observer] = (),
    settings: Settings | None = None,
) -> RunResult:
    """Runs an episode without ROS; its CSV has the bytes of `harness.run`, with --direct and without.

    The CSV's manifest stands beside it, so that `analyze` knows what was driven. Signals stay the
    caller's: Ctrl-C raises KeyboardInterrupt, and the rows so far are in the file.

    Args:
        run: What to run, with one rover.
        log_dir: Folder that gets both; made if it is not there.
        observers: See every batch of 50 ms: objects with a method `take(batch)`.
        settings: Of the metrics: thresholds, and whether there are extended columns; None for the
            defaults.

    Returns:
        What the run came to: `log_path` is the CSV, `failure` says why it ended early, if it did.

    Raises:
        UsageError: A value is not valid, there are several rovers, or the files cannot be written; the
            message names the mend.
    """
    run.check_single()
    output = Outputs(log_dir=Path(log_dir), observers=observers, settings=settings or Settings())
    (result,) = run_direct(run, (output,), RosOptions(log_dir=output.log_dir), StopRequest())
    if result.log_path is not None:
        write_manifest(result, result.log_path.with_suffix(".json"))
    return result
