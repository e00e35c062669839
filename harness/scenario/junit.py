"""Verdicts as JUnit XML: a test case a run; `failure` is an expectation, `error` could not be run."""

from collections.abc import Sequence

from junitparser import Error, Failure, Skipped
from junitparser.xunit2 import JUnitXml, TestCase, TestSuite

from harness.base.version import __version__
from harness.scenario.case import scenario_name
from harness.scenario.verdict import Attempt, Outcome, Verdict, outcome_of, reasons_of
from rover_metrics.errors import printable


def junit_of(verdicts: Sequence[Verdict]) -> str:
    """Returns verdicts as JUnit XML, a suite per scenario."""
    xml = JUnitXml()
    for verdict in verdicts:
        suite = TestSuite(printable(scenario_name(verdict.path)))  # type: ignore[no-untyped-call]  # of junitparser
        suite.add_property("file", printable(str(verdict.path)))
        suite.add_property("pass rate", f"{verdict.rate:.3g}")
        suite.add_property("interval", " to ".join(f"{limit:.3g}" for limit in verdict.interval))
        # Failures that the pass rate allows must not make the job red.
        forgiven = verdict.outcome is Outcome.PASSED
        suite.add_testcases([_case(attempt, forgiven=forgiven) for attempt in verdict.attempts])
        xml.add_testsuite(suite)
    text: bytes = xml.tostring()  # type: ignore[no-untyped-call]  # of junitparser
    return text.decode()


def properties_of(attempt: Attempt) -> dict[str, str]:
    """Returns what a reader needs to believe and repeat a run, by name."""
    factor = attempt.simulated_s / attempt.wall_s if attempt.wall_s else 0.0
    return {
        "again": attempt.case.command,
        "version": __version__,
        "model_hash": attempt.model_hash,
        "terrain_hash": attempt.terrain_hash,
        "simulated_s": f"{attempt.simulated_s:g}",
        "real_time_factor": f"{factor:.3g}",
        **({"unheeded": attempt.unheeded} if attempt.unheeded else {}),
        **({"kept": str(attempt.kept[0].parent)} if attempt.kept else {}),
    }


def _case(attempt: Attempt, *, forgiven: bool) -> TestCase:
    scenario = printable(scenario_name(attempt.case.path))
    case = TestCase(printable(attempt.case.name), scenario, attempt.wall_s)
    for name, value in properties_of(attempt).items():
        case.add_property(name, printable(value))
    outcome, lines = outcome_of(attempt), list(map(printable, reasons_of(attempt)))
    if outcome is Outcome.PASSED:
        return case
    kind: type[Error | Failure | Skipped] = Error if outcome is Outcome.ERROR else Failure
    if outcome is Outcome.EXPECTED or (forgiven and kind is Failure):
        kind = Skipped
    case.result = [kind(lines[0], outcome.value)]
    case.result[0].text = "\n".join([*lines, f"again: {printable(attempt.case.command)}"])
    return case
