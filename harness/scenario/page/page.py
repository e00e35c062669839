"""The page of a suite: what its template shows."""

from collections.abc import Sequence
from os.path import relpath
from pathlib import Path
from typing import Any
from urllib.parse import quote

from markupsafe import Markup

from harness.page.shell import fill
from harness.scenario.case import scenario_name
from harness.scenario.comparison import Comparisons
from harness.scenario.page.figures import height, plots_of
from harness.scenario.tables import HOW, sheets
from harness.scenario.verdict import Attempt, Outcome, Verdict, bad_runs, outcome_of, reasons_of
from rover_metrics.sheet.sheet import NONE, Sheet

CLASSES = {Outcome.PASSED: "complete", Outcome.FAILED: "failed", Outcome.ERROR: "interrupted"}


def render(several: Sequence[Comparisons], page: Path) -> str:
    """Returns the HTML of a suite for a page at a place, the same bytes for the same attempts."""
    verdicts = [compared.verdict for compared in several]
    scenarios = [
        _scenario(f"scenario-{number}", compared)
        for number, compared in enumerate(several)
        if len(compared.verdict.attempts) > 1
    ]
    plots = [plot for scenario in scenarios for plot in scenario["plots"]]
    content = {
        **_headline(verdicts),
        "bad": [_bad(attempt, page) for attempt in bad_runs(verdicts)],
        "overview": Sheet.of(_line(number, verdict) for number, verdict in enumerate(verdicts)),
        "scenarios": scenarios,
        "how": " ".join([HOW, *dict.fromkeys(filter(None, (each.power for each in several)))]),
    }
    return fill("suite", content, "harness.scenario.page", plots)


def _headline(verdicts: Sequence[Verdict]) -> dict[str, str]:
    count = len(verdicts)
    failed, errors = (sum(v.outcome is o for v in verdicts) for o in (Outcome.FAILED, Outcome.ERROR))
    counts = [f"{n} {words}" for n, words in ((failed, "failed"), (errors, "could not run")) if n]
    headline = f"{count} scenario{'' if count == 1 else 's'}: {', '.join(counts) or 'passed'}"
    worst = Outcome.ERROR if errors and not failed else Outcome.FAILED if failed else Outcome.PASSED
    return {"headline": headline, "state": CLASSES[worst]}


def _bad(attempt: Attempt, page: Path) -> dict[str, Any]:
    """A run that makes its scenario red, on a page at a place."""
    outcome, reasons = outcome_of(attempt), reasons_of(attempt)
    links = (quote(Path(relpath(path, page.parent)).as_posix()) for path in attempt.kept)
    is_text = any(path.suffix == ".txt" for path in attempt.kept[:1])  # it did not begin
    return {
        "name": attempt.case.name,
        "state": CLASSES.get(outcome, CLASSES[Outcome.FAILED]),
        "outcome": outcome.value,
        "reasons": reasons if attempt.error is None else reasons[:1],
        "words": "" if attempt.error is None else "\n".join(reasons[1:]),
        "again": attempt.case.command,
        "link": next(links, None),
        "linked": "What its programs said" if is_text else "The run: map, metrics, contacts",
    }


def _line(number: int, verdict: Verdict) -> dict[str, str]:
    """Returns the row of a scenario in the table of all; of several runs it links to their section."""
    several, name = len(verdict.attempts) > 1, scenario_name(verdict.path)
    state = Markup('<span class="state {}">{}</span>')
    return {
        "Scenario": Markup('<a href="#scenario-{}">{}</a>').format(number, name) if several else name,
        "Outcome": state.format(CLASSES[verdict.outcome], verdict.outcome.value),
        "Runs that pass": f"{verdict.good} of {len(verdict.attempts)}",
        "95 % interval": " to ".join(f"{e:.0%}" for e in verdict.interval) if several else NONE,
        "What is checked": verdict.attempts[0].case.scenario.about,
    }


def _scenario(name: str, compared: Comparisons) -> dict[str, Any]:
    plots = [*plots_of(name, compared)]
    return {
        "anchor": name,
        "name": scenario_name(compared.verdict.path),
        "about": compared.verdict.attempts[0].case.scenario.about,
        "height": height(compared.cells),
        "plots": plots,
        "tables": sheets(compared),
    }
