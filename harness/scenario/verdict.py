"""Verdicts on a run, and on a scenario whose runs need not all pass."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from harness.base.errors import how_many
from harness.scenario.baseline import Recorded
from harness.scenario.case import Case
from rover_metrics.analysis.statistics.summary import wilson

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Measured:
    """What a quantity came to in a run: what its bound compares.

    Attributes:
        value: In `unit`; None where there was none.
        unit: Empty for counts, flags and columns of the log.
    """

    value: float | None
    unit: str = ""


@dataclass(frozen=True)
class Attempt:
    """What a run of a scenario came to.

    Attributes:
        breaches: What was not as expected, in the order of the file.
        error: Why it could not be run; None if it could.
        simulated_s: Simulated time [s]; `wall_s` is the wall time that it took [s].
        model_hash: Hash of the rover's model, as that of the terrain "" if it could not run.
        recorded: What a baseline keeps of it; None if it has none.
        kept: What is left of a run that did not pass.
        measured: What each bound of the scenario compares, in their order; nothing if it could not run.
        unheeded: Which commands of nodes the rover did not follow, and why; also the last of breaches.
    """

    case: Case
    breaches: tuple[str, ...] = ()
    error: str | None = None
    simulated_s: float = 0.0
    wall_s: float = 0.0
    model_hash: str = ""
    terrain_hash: str = ""
    recorded: Recorded | None = None
    kept: tuple[Path, ...] = ()
    measured: tuple[Measured, ...] = ()
    unheeded: str = ""

    @property
    def passed(self) -> bool:
        """Whether all was as expected."""
        return not self.breaches and self.error is None


class Outcome(StrEnum):
    """What is said of a run."""

    PASSED = "passed"
    FAILED = "failed"
    EXPECTED = "failed as expected"
    UNEXPECTED = "passed, but was expected to fail"
    ERROR = "could not run"

    @property
    def is_good(self) -> bool:
        """Whether the scenario may be green with it."""
        return self in (Outcome.PASSED, Outcome.EXPECTED)


def outcome_of(attempt: Attempt) -> Outcome:
    """Returns what is said of a run."""
    if attempt.error is not None:
        return Outcome.ERROR
    if attempt.case.expected_failure is None:
        return Outcome.PASSED if attempt.passed else Outcome.FAILED
    return Outcome.UNEXPECTED if attempt.passed else Outcome.EXPECTED


def reasons_of(attempt: Attempt) -> tuple[str, ...]:
    """Returns why an outcome is not PASSED, each in a line."""
    if attempt.error is not None:
        return tuple(attempt.error.splitlines())
    known = attempt.case.expected_failure
    if known is None:
        return attempt.breaches
    if attempt.passed:
        return (f"passed, but was expected to fail: {known.reason}",)
    return (f"failed as expected: {known.reason}", *attempt.breaches)


@dataclass(frozen=True)
class Runs:
    """Several runs, and how many of them are good."""

    attempts: tuple[Attempt, ...]

    @property
    def good(self) -> int:
        """How many are as they should be."""
        return sum(outcome_of(attempt).is_good for attempt in self.attempts)

    @property
    def interval(self) -> tuple[float, float]:
        """Of their share, by Wilson's method, at 95 %."""
        return wilson(self.good, len(self.attempts), CONFIDENCE)


@dataclass(frozen=True)
class Verdict(Runs):
    """What is said of a scenario, of all its runs."""

    path: Path

    @property
    def rate(self) -> float:
        """Share of the runs that are good."""
        return self.good / len(self.attempts)

    @property
    def outcome(self) -> Outcome:
        """ERROR if a run could not be run, else PASSED or FAILED."""
        if any(attempt.error is not None for attempt in self.attempts):
            return Outcome.ERROR
        asked = self.attempts[0].case.scenario.pass_rate
        passed = self.rate >= (1.0 if asked is None else asked.min)
        return Outcome.PASSED if passed else Outcome.FAILED


def bad_runs(verdicts: Iterable[Verdict]) -> Iterator[Attempt]:
    """Yields every run that makes its scenario red."""
    for verdict in verdicts:
        if verdict.outcome is not Outcome.PASSED:
            yield from (each for each in verdict.attempts if not outcome_of(each).is_good)


def passed_of(verdicts: Sequence[Verdict]) -> str:
    """Returns how many scenarios passed, e.g. "2 of 3 scenarios passed"."""
    passed = sum(verdict.outcome is Outcome.PASSED for verdict in verdicts)
    return f"{passed} of {how_many(len(verdicts), 'scenario')} passed"


def verdicts_of(attempts: Sequence[Attempt]) -> list[Verdict]:
    """Returns the verdict of each scenario, in the order of its first run."""
    by_path: dict[Path, list[Attempt]] = {}
    for attempt in attempts:
        by_path.setdefault(attempt.case.path, []).append(attempt)
    return [Verdict(tuple(some), path) for path, some in by_path.items()]


def exit_code(verdicts: Sequence[Verdict]) -> int:
    """Returns 0 if all passed, 2 if a run could not be run, else 1."""
    outcomes = {verdict.outcome for verdict in verdicts}
    return 2 if Outcome.ERROR in outcomes else int(Outcome.FAILED in outcomes)
