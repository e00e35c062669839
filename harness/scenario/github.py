"""What GitHub shows of scenarios: a job's summary, and an annotation where the file expects too much."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.base.errors import how_many
from harness.scenario.case import scenario_name
from harness.scenario.terminal import kept_limits
from harness.scenario.verdict import Verdict, bad_runs, passed_of, reasons_of
from rover_metrics.sheet.render import markdown
from rover_metrics.sheet.sheet import Sheet

PROPERTY = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A", ":": "%3A", ",": "%2C"})
DATA = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A"})


def tell_github(verdicts: Sequence[Verdict], environment: Mapping[str, str]) -> None:
    """Annotates what was not kept and appends to the summary, if `GITHUB_ACTIONS` says so."""
    if environment.get("GITHUB_ACTIONS") != "true":
        return
    for line in annotations(verdicts):
        print(line)
    if target := environment.get("GITHUB_STEP_SUMMARY"):
        with Path(target).open("a", encoding="utf-8") as file:
            file.write(summary(verdicts, environment))


def annotations(verdicts: Sequence[Verdict]) -> list[str]:
    """Returns the workflow commands that mark each line of a scenario which runs did not keep, once.

    GitHub shows few of a job: the first run of a line is told, and how many more there are.
    """
    told = dict[tuple[Path, int, str], dict[str, str]]()  # what each run did there
    for attempt in bad_runs(verdicts):
        path, reasons = attempt.case.path, reasons_of(attempt)
        for reason in reasons if attempt.error is None else reasons[:1]:
            line = _line(path, reason)
            runs = told.setdefault((path, line, "" if line else reason), {})
            runs.setdefault(attempt.case.name, reason)
    return [_annotation(path, line, runs) for (path, line, _), runs in told.items()]


def _annotation(path: Path, line: int, runs: Mapping[str, str]) -> str:
    (name, reason), more = next(iter(runs.items())), len(runs) - 1
    others = f" and {how_many(more, 'more run')}" if more else ""
    said = f"{reason} ({name}{others})"
    place = f"file={str(path).translate(PROPERTY)},line={line or 1}"
    return f"::error {place},title={scenario_name(path).translate(PROPERTY)}::{said.translate(DATA)}"


def summary(verdicts: Sequence[Verdict], environment: Mapping[str, str]) -> str:
    """Returns Markdown: a row each scenario, the first failure, where its evidence is."""
    table = Sheet.of(
        {
            "scenario": scenario_name(verdict.path),
            "outcome": verdict.outcome.value,
            "runs": str(len(verdict.attempts)),
            "against its limits": "; ".join(kept_limits(verdict.attempts)),
        }
        for verdict in verdicts
    )
    parts = [f"### {passed_of(verdicts)}", markdown(table).strip()]
    first = next(bad_runs(verdicts), None)
    if first is not None:
        reasons = "\n".join(f"    {line}" for line in reasons_of(first))
        parts.append(f"First failure, `{first.case.name}`:\n\n{reasons}\n\n    {first.case.command}")
        parts.append(f"[Page, log and evidence of what failed]({_run_of(environment)}#artifacts)")
    return "\n\n".join(parts) + "\n"


def _line(path: Path, reason: str) -> int:
    """The line of a scenario's file that names the quantity of a breach; 0 if none does."""
    name = reason.partition(": ")[0].partition(" of ")[0]
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if path.is_file() else []
    key = re.compile(rf"\s*[\"']?{re.escape(name)}[\"']?\s*:")
    return next((number for number, line in enumerate(lines, 1) if key.match(line)), 0)


def _run_of(environment: Mapping[str, str]) -> str:
    server = environment.get("GITHUB_SERVER_URL", "https://github.com")
    repository, run = environment.get("GITHUB_REPOSITORY", ""), environment.get("GITHUB_RUN_ID", "")
    return f"{server}/{repository}/actions/runs/{run}"
