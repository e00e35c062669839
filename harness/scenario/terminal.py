"""What a console shows of scenarios: a line each; of a bad run what, where and how to see it again."""

from collections.abc import Sequence

from rich.console import Console

from harness.base.errors import how_many
from harness.scenario.case import scenario_name
from harness.scenario.verdict import Attempt, Outcome, Verdict, outcome_of, reasons_of

_STYLES = {
    Outcome.PASSED: "green",
    Outcome.EXPECTED: "yellow",
    Outcome.UNEXPECTED: "red",
    Outcome.FAILED: "red",
    Outcome.ERROR: "magenta",
}


def print_verdicts(console: Console, verdicts: Sequence[Verdict]) -> None:
    """Prints each scenario, and of each run that is not as it should be why, and the command for it."""
    for verdict in verdicts:
        _line(console, verdict.outcome, scenario_name(verdict.path) + _rate(verdict))
        for attempt in verdict.attempts:
            if outcome_of(attempt) is not Outcome.PASSED:
                _print_run(console, attempt)
    passed = sum(verdict.outcome is Outcome.PASSED for verdict in verdicts)
    runs = [attempt for verdict in verdicts for attempt in verdict.attempts]
    simulated, wall = sum(a.simulated_s for a in runs), sum(a.wall_s for a in runs)
    speed = f", {simulated / wall:.0f}x real time a process" if wall else ""
    text = (
        f"{passed} of {how_many(len(verdicts), 'scenario')} passed: {how_many(len(runs), 'run')}{speed}"
    )
    console.print(text, soft_wrap=True)


def _rate(verdict: Verdict) -> str:
    if len(verdict.attempts) == 1:
        return ""
    low, high = verdict.interval
    count = len(verdict.attempts)
    return f": {round(verdict.rate * count)} of {count} runs (95 % interval {low:.0%} to {high:.0%})"


def _print_run(console: Console, attempt: Attempt) -> None:
    outcome = outcome_of(attempt)
    _line(console, outcome, attempt.case.name, indent="  ")
    lines = [*reasons_of(attempt)]
    if not outcome.is_good:
        lines.append(f"again: {attempt.case.command}")
    lines += [f"see:   {path}" for path in attempt.kept[:1]]
    for line in lines:
        console.print(f"    {line}", soft_wrap=True)


def _line(console: Console, outcome: Outcome, text: str, indent: str = "") -> None:
    console.print(f"{indent}{outcome.value}", style=_STYLES[outcome], end=" ")
    console.print(text, soft_wrap=True)
