"""What is left of a run that did not pass: log, manifest, page."""

from dataclasses import replace
from pathlib import Path
from shutil import copy2, rmtree

from harness.episode.manifest import write_manifest
from harness.episode.result import RunResult
from harness.files import write_whole
from harness.report.recorder import RunRecorder

PAGE = "run.html"


def keep_evidence(
    result: RunResult, recorder: RunRecorder, folder: Path, reason: str
) -> tuple[Path, ...]:
    """Puts log, manifest and page of a run into a folder; returns their places.

    Args:
        result: What the run came to.
        recorder: Has watched it.
        folder: Is made; one of an earlier run is replaced.
        reason: Why it did not pass, for manifest and page.
    """
    from harness.report.content import render  # noqa: PLC0415 - a second that passing runs save

    if (folder / PAGE).exists():  # only what an earlier run has left
        rmtree(folder)
    folder.mkdir(parents=True, exist_ok=True)
    log, page = result.log_path, folder / PAGE
    kept = [page]
    if log is not None:
        kept.append(Path(copy2(log, folder / log.name)))
    told = replace(
        result, log_path=kept[-1] if log else None, report=page, failure=result.failure or reason
    )
    if log is not None:
        kept.append(folder / log.with_suffix(".json").name)
        write_manifest(told, kept[-1])
    write_whole(page, render(told, recorder), "the page")
    return tuple(kept)
