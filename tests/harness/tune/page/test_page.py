"""The report of a tuning: what stands on it, without a browser."""

import json
import re
from dataclasses import replace
from html import unescape
from itertools import pairwise
from typing import TYPE_CHECKING
from zlib import crc32

import numpy as np
import pytest

from harness.tune.output import parameter_file
from harness.tune.page.sample_figures import MOST_POINTS, has_both_classes, precision_recall, roc
from harness.tune.page.subject import levels
from harness.tune.page.tables import score_text
from harness.tune.scoring.estimate import Estimate
from tests.harness.tune.conftest import COMMAND, rendered
from tests.support.pages import Outline, described_page
from tests.support.snapshots import check_snapshot

if TYPE_CHECKING:
    from tests.harness.tune.conftest import Sweep


def test_tables_and_figures_of_a_tuning_are_as_somebody_has_checked(small_page: str) -> None:
    text = described_page(small_page)
    assert all(later <= earlier + 1 for earlier, later in pairwise(Outline(text).levels))
    assert "<b>" not in text  # of the command
    assert len(small_page.encode()) < 3_000_000
    check_snapshot("tuning.html.txt", text)
    figures = re.search(r'id="figures">(.*?)</script>', small_page, re.DOTALL)
    assert figures
    short = re.sub(r"\d+\.\d+(e-?\d+)?", lambda number: f"{float(number[0]):.4g}", figures[1])
    lines = (f"{name} {crc32(json.dumps(one).encode())}\n" for name, one in json.loads(short).items())
    check_snapshot("tuning_figures.txt", "".join(lines))


def test_same_arguments_give_the_same_page(small_page: str, small_sweep: "Sweep") -> None:
    assert rendered(small_sweep) == small_page
    assert all(parameter_file(study, COMMAND) in unescape(small_page) for study in small_sweep[0])


def test_a_gain_has_a_sign_and_its_interval() -> None:
    minus = "\N{MINUS SIGN}"
    for score, expected in (
        (Estimate(-0.25, -0.5, 0.125), f"{minus}0.25 ({minus}0.50 to +0.12)"),
        (Estimate(0.5), "+0.50 (no interval)"),
        (Estimate(float("nan")), "\N{EN DASH}"),
    ):
        assert score_text(score, sign="+").replace("\N{NO-BREAK SPACE}", " ") == expected


def test_only_a_value_that_is_proven_is_called_tuned(small_sweep: "Sweep") -> None:
    proven = small_sweep[0][0].collision.verdict
    doubtful = replace(proven, gain={"F1": Estimate(0.1, -0.1, 0.3)})
    assert [shape["name"] for shape in levels(proven)][1].startswith("tuned 0.")
    assert [shape["name"] for shape in levels(doubtful)][1].startswith("chosen (not proven) 0.")


def test_curves_of_many_values_are_thinned_and_keep_their_ends_and_their_area() -> None:
    rng = np.random.default_rng(0)
    truth = rng.random(20_000) < 0.1
    score = rng.normal(truth * 2.0)
    curve, along = roc(score, truth), precision_recall(score, truth)
    assert len(curve.x) <= MOST_POINTS + 1
    assert (curve.x[0], curve.y[0], curve.x[-1], curve.y[-1]) == (0.0, 0.0, 1.0, 1.0)
    assert np.trapezoid(curve.y, curve.x) == pytest.approx(curve.area, abs=0.002)
    assert abs(curve.area - 0.921) < 0.01  # Phi(2 / sqrt 2)
    assert 0.0 < float(along.x[0]) < float(along.x[-1]) == 1.0
    assert along.y[-1] == pytest.approx(truth.mean())
    assert [has_both_classes(np.array(some, bool)) for some in ([1], [], [0, 1])] == [False, False, True]
