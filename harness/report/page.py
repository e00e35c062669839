"""The page of a run."""

from harness.report.content import content
from harness.report.recorder import RunRecorder
from harness.report.shell import fill
from harness.result import RunResult


def render(result: RunResult, recorder: RunRecorder) -> str:
    """The HTML of a run's report."""
    return fill("report", content(result, recorder))
