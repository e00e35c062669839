"""Every number as CSV, read back."""

import csv
from dataclasses import replace
from pathlib import Path

from rover_metrics.analysis.tables.export import write_csv

from rover_metrics.analysis.result import Result
from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.correlation import Correlation
from tests.support import results

LOG = replace(results.LOG, label="=1+1", group="a")
RESULT = replace(results.RESULT, logs=(LOG,), groups=("a", "b"))


def read(result: Result, folder: Path) -> dict[str, list[dict[str, str]]]:
    found = {}
    for path in write_csv(result, folder):
        with path.open(newline="") as file:
            found[path.name] = list(csv.DictReader(file))
    return found


def test_logs_are_one_row_a_metric_with_every_number(tmp_path: Path) -> None:
    tables = read(RESULT, tmp_path)
    assert tables == {
        "logs.csv": [
            {
                "log": "'=1+1",  # no formula
                "path": "x.csv",
                "group": "a",
                "code": "CV",
                "title": "Current velocity [m/s]",
                "n": "60",
                "mean": "0.52",
                "n_effective": "21.4",
                "median": "0.51",
                "sd": "0.08",
                "minimum": "0.12",
                "maximum": "0.93",
                "interval_low": "0.5",
                "interval_high": "0.54",
                "bootstrap_interval_low": "0.47",
                "bootstrap_interval_high": "0.57",
                "block_length": "4",
                "outliers": "3",
                "per_metre": "1.75",
            }
        ]
    }


def test_groups_comparisons_and_correlations_have_a_file_each(tmp_path: Path) -> None:
    compared = Comparison("CV", (3, 4), (0.1, None), 0.25, (0.15, 0.375), paired=True)
    pair = Correlation("CV", "OC", 0.3, 50, 20.6, 0.02)
    result = replace(
        RESULT,
        logs=(LOG, LOG),
        across={"a": {"CV": replace(results.SPEED, bootstrap_interval=None)}},
        comparisons=(compared,),
        correlations=(pair,),
    )
    tables = read(result, tmp_path)
    assert list(tables) == ["logs.csv", "across.csv", "comparison.csv", "correlation.csv"]
    across, comparison = tables["across.csv"][0], tables["comparison.csv"][0]
    assert (across["group"], across["bootstrap_interval_low"]) == ("a", "")
    names = ["code", "title", "n_first", "n_second", "means_first", "means_second"]
    names += ["interval_low", "interval_high", "paired", "p"]
    cells = ["CV", "Current velocity [m/s]", "3", "4", "0.1", "", "0.15", "0.375", "True", ""]
    assert [comparison[name] for name in names] == cells
    assert tables["correlation.csv"][0]["rho"] == "0.3"
