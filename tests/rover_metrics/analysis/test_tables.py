"""What people read of a result, and what programs do."""

import json
from dataclasses import replace
from pathlib import Path

from rover_metrics.analysis.metric import METRICS
from rover_metrics.analysis.outcome import Result
from rover_metrics.analysis.output import write_csv
from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.correlation import Correlation
from rover_metrics.analysis.statistics.summary import Summary
from rover_metrics.analysis.tables import sheets
from rover_metrics.sheet.render import markdown
from tests.support.results import LOG, RESULT, SPEED
from tests.support.snapshots import check_snapshot

SHARE = Summary(60, 12.5, 9.0, interval=(6.0, 22.0))
COMPARISON = Comparison(
    "CV", (3, 4), (0.1, 0.35), 0.25, (0.15, 0.375), "exact permutation", 0.02, 0.03, 0.05, 1.234, -0.5
)
UNTESTED = replace(COMPARISON, test=None, p=None, p_holm=None, smallest_p=None)
TWO = replace(RESULT, groups=("a", "b"), unit="episode", notes=("So few episodes.", "Really."))
LONG = replace(LOG, rows=1, duration=1234567.25, episodes=3, findings=("one", "two"), group="b")
PAIRS = (
    Correlation("CV", "OC", 0.3, 50, 20.6, 0.02, 0.04),
    Correlation("TC", "OC", -0.456, 60, 30.0, 0.0001, None),
)
RESULTS = {
    "one log": RESULT,
    "outliers removed": replace(RESULT, outliers_removed=True),
    "two groups of logs": replace(
        RESULT,
        logs=(LONG, LOG),
        groups=("a", "b"),
        across={"a": {"CV": SPEED, "RT": SHARE}, "b": {"CV": Summary(0)}},
    ),
    "two logs in one group": replace(RESULT, logs=(LOG, LOG), across={"all logs": {"CV": SPEED}}),
    "correlations": replace(RESULT, correlations=PAIRS),
    "compared": replace(
        TWO, comparisons=(COMPARISON, replace(COMPARISON, code="OC", test="Mann-Whitney U"))
    ),
    "compared pair by pair": replace(TWO, comparisons=(replace(COMPARISON, paired=True, n=(3, 3)),)),
    "compared without a test": replace(TWO, comparisons=(UNTESTED,)),
}


def described(result: Result) -> str:
    """Every table of a result, with all that is about it."""
    return "\n".join(
        f"{sheet.title}\n"
        f"{sheet.file}, codes {sheet.codes}, odd {sheet.findings}, spare {sorted(sheet.spare)}\n"
        f"{sheet.caption}\n{markdown(sheet)}"
        for sheet in sheets(result)
    )


def test_the_tables_of_results_are_as_somebody_has_checked() -> None:
    parts = (f"== {name}\n{described(result)}\n" for name, result in RESULTS.items())
    codes = (f"{metric}\n" for metric in METRICS.values())  # words of the command line
    check_snapshot("tables.txt", "".join([*parts, *codes]))


def test_every_number_is_in_the_csv_files(tmp_path: Path) -> None:
    compared = Comparison("CV", (3, 4), (0.1, None), 0.25, (0.15, 0.375), paired=True)
    log = replace(LOG, label="=1+1", group="a")
    result = replace(
        RESULT,
        logs=(log, log),
        groups=("a", "b"),
        across={"a": {"CV": replace(SPEED, bootstrap_interval=None)}},
        comparisons=(compared,),
        correlations=PAIRS[:1],
    )
    parts = [f"== {path.name}\n{path.read_text()}" for path in write_csv(result, tmp_path)]
    check_snapshot("numbers.csv.txt", "\n".join(parts))
    assert [path.name for path in write_csv(RESULT, tmp_path)] == ["logs.csv"]


def test_json_has_every_field_and_null_for_what_is_no_number() -> None:
    odd = replace(SPEED, mean=float("nan"), interval=(0.5, float("inf")))
    (log,) = json.loads(replace(RESULT, logs=(replace(LOG, metrics={"CV": odd}),)).to_json())["logs"]
    assert (log["metrics"]["CV"]["mean"], log["metrics"]["CV"]["interval"]) == (None, [0.5, None])
    assert (log["rows"], log["per_metre"], log["metrics"]["CV"]["sd"]) == (60, {"CV": 1.75}, 0.08)
