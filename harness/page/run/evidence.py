"""What is left of a run that did not pass: its page, log, manifest and whatever else tells about it."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from shutil import copy2

from harness.base.files import write_whole
from harness.episode.manifest import write_manifest
from harness.episode.result import RunResult
from harness.page.run.recorder import RunRecorder

RECORDING = ".mcap"


def keep_evidence(
    result: RunResult, recorder: RunRecorder, page: Path, reason: str, more: Iterable[Path | None] = ()
) -> tuple[Path, ...]:
    """Writes the page of a run, and its log, manifest and other files beside it.

    Args:
        result: What the run came to; without a log it leaves no manifest.
        recorder: Has watched the run.
        page: The page's file; its folder is made, files of the same names are replaced.
        reason: Why the run did not pass, for page and manifest; "" of one that passed.
        more: Other files to copy there; None for one that there is not.

    Returns:
        What is there now, the page first.

    Raises:
        HarnessError: Something cannot be written; also OSError.
    """
    from harness.page.run.content import render  # noqa: PLC0415 - a second that passing runs save

    folder = page.parent
    folder.mkdir(parents=True, exist_ok=True)
    log = None if result.log_path is None else Path(copy2(result.log_path, folder))
    others = [Path(copy2(path, folder)) for path in more if path is not None]
    kept_result = replace(
        result,
        log_path=log,
        report=page,
        recording=next((path for path in others if path.suffix == RECORDING), None),
        failure=result.failure or reason or None,
    )
    write_whole(page, render(kept_result, recorder), "the page")
    if log is None:
        return page, *others
    write_manifest(kept_result, log.with_suffix(".json"))
    return page, log, log.with_suffix(".json"), *others
