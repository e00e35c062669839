"""What a console shows of scenarios: a line each; of a bad run what, where and how to see it again."""

from collections.abc import Sequence

from rich.console import Console

from harness.base.errors import how_many
from harness.scenario.case import scenario_name
from harness.scenario.verdict import (
    Attempt,
    Measured,
    Outcome,
    Verdict,
    outcome_of,
    passed_of,
    reasons_of,
)

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
        errors: dict[str, int] = {}  # what keeps runs from being driven, and how many of them
        for attempt in verdict.attempts:
            if attempt.error is not None:
                errors[attempt.error] = errors.get(attempt.error, 0) + 1
            if outcome_of(attempt) is not Outcome.PASSED and errors.get(attempt.error or "", 1) == 1:
                _print_run(console, attempt)
        for count in filter(lambda count: count > 1, errors.values()):
            console.print(f"    and {how_many(count - 1, 'more run')} for the same reason")
        if verdict.outcome is Outcome.PASSED:
            for line in kept_limits(verdict.attempts):
                console.print(f"    {line}", style="dim", soft_wrap=True)
            for attempt in verdict.attempts:
                if attempt.passed and attempt.unheeded:
                    said = f"    {attempt.case.name}: {attempt.unheeded}"
                    console.print(said, style="yellow", soft_wrap=True)
    runs = [attempt for verdict in verdicts for attempt in verdict.attempts]
    simulated, wall = sum(a.simulated_s for a in runs), sum(a.wall_s for a in runs)
    speed = f", {simulated / wall:.0f}x real time a process" if wall else ""
    console.print(f"{passed_of(verdicts)}: {how_many(len(runs), 'run')}{speed}", soft_wrap=True)


def kept_limits(attempts: Sequence[Attempt]) -> list[str]:
    """Returns what each quantity came to beside its limits, e.g. "truth.tilt_deg: 12.3 deg (<= 25)".

    Several runs are shown by the least and the largest value: "truth.tilt_deg: 9.1 to 12.3 deg (<= 25)".
    """
    bounds, runs = attempts[0].case.scenario.bounds, zip(*(a.measured for a in attempts), strict=False)
    return [
        f"{bound.label(name)}: {_shown(measured)} ({bound.limits})"
        for (name, bound), measured in zip(bounds, runs, strict=False)
    ]


def _shown(measured: Sequence[Measured]) -> str:
    values = sorted(each.value for each in measured if each.value is not None)
    if not values:
        return "no value"
    ends = dict.fromkeys(f"{value:.4g}" for value in (values[0], values[-1]))
    return f"{' to '.join(ends)} {measured[0].unit}".rstrip()


def _rate(verdict: Verdict) -> str:
    if len(verdict.attempts) == 1:
        return ""
    low, high = verdict.interval
    count = len(verdict.attempts)
    return f": {verdict.good} of {count} runs (95 % interval {low:.0%} to {high:.0%})"


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
