"""What is left of a run that did not pass: log, manifest, page, and what it has recorded."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from shutil import copy2, rmtree

from harness.base.files import write_whole
from harness.episode.manifest import write_manifest
from harness.episode.result import RunResult
from harness.report.recorder import RunRecorder

PAGE, RECORDING = "run.html", ".mcap"


def keep_evidence(
    result: RunResult, recorder: RunRecorder, folder: Path, reason: str, more: Iterable[Path] = ()
) -> tuple[Path, ...]:
    """Puts log, manifest and page of a run into a folder; returns their places.

    Args:
        result: What the run came to.
        recorder: Has watched it.
        folder: Is made; one of an earlier run is replaced.
        reason: Why it did not pass, for manifest and page.
        more: Other files to put there.
    """
    from harness.report.content import render  # noqa: PLC0415 - a second that passing runs save

    if (folder / PAGE).exists():  # only what an earlier run has left
        rmtree(folder)
    folder.mkdir(parents=True, exist_ok=True)
    log, page = result.log_path, folder / PAGE
    kept = [page]
    if log is not None:
        kept.append(Path(copy2(log, folder / log.name)))
    log_path = kept[-1] if log else None
    others = [Path(copy2(path, folder / path.name)) for path in more]
    told = replace(
        result,
        log_path=log_path,
        report=page,
        recording=next((path for path in others if path.suffix == RECORDING), None),
        failure=result.failure or reason,
    )
    if log is not None:
        kept.append(folder / log.with_suffix(".json").name)
        write_manifest(told, kept[-1])
    write_whole(page, render(told, recorder), "the page")
    return (*kept, *others)
