"""An episode from Python: a configuration in, a CSV and what the run came to out."""

from collections.abc import Sequence
from pathlib import Path

from harness.base.interrupt import StopRequest
from harness.config import EpisodeConfig, RosOptions
from harness.episode.direct import DEFAULT_SETTINGS, run_direct
from harness.episode.loop import Observer
from harness.episode.manifest import write_manifest
from harness.episode.result import RunResult
from rover_metrics.extended.settings import Settings


def run_episode(
    config: EpisodeConfig,
    log_dir: Path | str,
    *,
    observers: Sequence[Observer] = (),
    settings: Settings = DEFAULT_SETTINGS,
) -> RunResult:
    """Runs an episode without ROS; its CSV has the bytes of `harness.run`, with --direct and without.

    The CSV's manifest stands beside it, so that `analyze` knows what was driven. Signals stay the
    caller's: Ctrl-C raises KeyboardInterrupt, and the rows so far are in the file.

    Args:
        config: What to run.
        log_dir: Folder that gets both; made if it is not there.
        observers: See every batch of 50 ms: objects with a method `take(batch)`.
        settings: Of the metrics: thresholds, and whether there are extended columns.

    Returns:
        What the run came to: `log_path` is the CSV, `failure` says why it ended early, if it did.

    Raises:
        UsageError: A value is not valid or the files cannot be written; the message names the mend.
    """
    options = RosOptions(log_dir=Path(log_dir))
    result = run_direct(config, options, StopRequest(), observers=observers, settings=settings)
    if result.log_path is not None:
        write_manifest(result, result.log_path.with_suffix(".json"))
    return result
