"""Experiments: quantities without limits, compared within each ground, written as papers need them."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.scenario.__main__ import main
from harness.scenario.case import plan
from harness.scenario.comparison import Comparisons, comparisons_of
from harness.scenario.tables import latex_of, sheets
from harness.scenario.verdict import Attempt, Measured, verdicts_of
from rover_metrics.analysis.statistics.comparison import compare

ROBOTS = "leo", "rover_zero4wd"
TEXT = """
about: Which rover tilts less, on two grounds.
duration: 1
seeds: {seeds}
matrix: {{robot: [leo, rover_zero4wd], terrain: [flat, gravel]}}
compare: robot
measure:
  truth.tilt_deg: {{over: p95}}
  truth.path_length: {{over: end}}
"""


def compared(tmp_path: Path, seeds: int) -> tuple[Comparisons, np.ndarray]:
    """An experiment whose runs came to random values, shape (cells, seeds, quantities)."""
    (tmp_path / "x.scenario.yaml").write_text(TEXT.format(seeds=seeds))
    cases = plan([tmp_path / "x.scenario.yaml"])
    values = np.random.default_rng(1).normal(size=(4, seeds, 2))
    values[2:, :, 0] += 5.0  # rover_zero4wd tilts more
    flat = values.reshape(-1, 2).tolist()
    attempts = [Attempt(c, measured=tuple(map(Measured, v))) for c, v in zip(cases, flat, strict=True)]
    return comparisons_of(verdicts_of(attempts)[0]), values


def test_robots_are_compared_within_each_ground_pair_by_pair(tmp_path: Path) -> None:
    found, values = compared(tmp_path, 10)
    tilt = found.quantities[0]
    assert [row.difference is None for row in tilt.rows] == [True, True, False, False]
    for ground, row in enumerate(tilt.rows[2:]):
        own = compare("", values[ground, :, 0], values[2 + ground, :, 0], 0.95, paired=True)
        assert row.difference is not None
        assert row.difference.difference == pytest.approx(own.difference)
        assert row.difference.p == own.p
        assert row.difference.hedges_g == pytest.approx(own.hedges_g)
    table = sheets(found)[0]  # nothing is expected, so no table says what passed
    assert table.titles[:3] == ("within", "leo", "rover_zero4wd")
    assert [row[0] for row in table.rows] == ["flat", "gravel"]
    assert found.power == ""


def test_too_few_seeds_are_told_once(tmp_path: Path) -> None:
    found, _ = compared(tmp_path, 4)
    assert found.power.startswith("4 seeds cannot give p (Holm) < 0.05 in 4 comparisons")
    assert [bool(sheet.caption) for sheet in sheets(found)] == [False, True]
    text = latex_of([found])
    assert text.count("cannot give") == 1
    assert text.count("Seeds 0 to 3; n = 4 runs in each cell; test: exact sign flips.") == 2
    assert text.count("& difference &") == 2


def test_an_experiment_is_one_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.scenario.yaml").write_text(TEXT.format(seeds=2))
    words = ["--jobs", "1", "--keep", "--runs", "runs.csv", "--latex", "t.tex", "--plot", "box.svg"]
    assert main(["x.scenario.yaml", *words]) == 0
    with (tmp_path / "runs.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["robot"], row["terrain"], row["seed"]) for row in rows[:3]] == [
        ("leo", "flat", "0"),
        ("leo", "flat", "1"),
        ("leo", "gravel", "0"),
    ]
    assert all(float(row["truth.path_length, at the end [m]"]) > 0.0 for row in rows)
    assert all(Path(row["log"]).is_file() for row in rows)
    boxes = re.findall(r">([a-z_0-9, ]+) \(n = 2\)<", (tmp_path / "box.svg").read_text())
    on_flat, on_gravel = ([f"{robot}, {ground}" for robot in ROBOTS] for ground in ("flat", "gravel"))
    assert boxes == 2 * [*on_flat, *on_gravel], "what is compared stands together"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("compare: robot", "compare: driver", "available: robot, terrain"),
        ("compare: robot", "compare: rover", "available: robot, terrain"),
        ("{over: p95}", "{over: p95, max: 3}", "no limits"),
        ("{over: p95}", "{over: share}", "no limits"),
        ("{over: p95}", "{window: [0, 9]}", "after the run"),
        ("measure:", "expected:", "did you mean 'expect"),
        ("truth.tilt_deg", "truth.tilt", "did you mean 'truth.tilt_deg'"),
    ],
)
def test_a_mistake_is_told_with_its_mend(tmp_path: Path, old: str, new: str, words: str) -> None:
    (tmp_path / "x.scenario.yaml").write_text(TEXT.format(seeds=2).replace(old, new))
    with pytest.raises(UsageError) as told:
        plan([tmp_path / "x.scenario.yaml"])
    assert words in str(told.value)
