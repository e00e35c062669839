"""The page of a run."""

from harness.episode.result import RunResult
from harness.page.shell import fill
from harness.report.content import content
from harness.report.recorder import RunRecorder


def render(result: RunResult, recorder: RunRecorder) -> str:
    """The HTML of a run's report."""
    return fill("report", content(result, recorder))
