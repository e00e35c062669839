"""The report of a tuning: what stands on it, without a browser."""

import re
from collections.abc import Mapping
from dataclasses import replace
from html import unescape
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pytest

from harness.tune.episodes.plan import Part
from harness.tune.page.contact_figures import FALSE_ALARMS, frontier
from harness.tune.page.page import render
from harness.tune.page.sample_figures import ground_figures, scan_figures
from harness.tune.page.subject import Subject, levels
from harness.tune.page.tables import _text, clearance
from harness.tune.parameter_file import parameter_file
from harness.tune.scoring.estimate import Estimate
from harness.tune.scoring.ground import SIGNALS
from harness.tune.scoring.study import scored_records
from tests.support.pages import Outline, without_plotly

if TYPE_CHECKING:
    from tests.harness.tune.conftest import Sweep


@pytest.fixture(scope="module")
def page(small_page: str) -> str:
    """The page without plotly."""
    return without_plotly(small_page)


@pytest.fixture
def command(page: str) -> str:
    """What the page says that it was made with."""
    return unescape(re.findall(r"<pre tabindex=\"0\">([^<]*)</pre>", page)[0])


def cells_of(page: str, threshold: str) -> list[str]:
    """The cells of the first row of a threshold."""
    row = page[page.index(f'<th scope="row">{threshold}</th>') :].partition("</tr>")[0]
    return re.findall(r"<td[^>]*>([^<]*)</td>", row)


def test_headings_are_in_order_and_every_tag_is_closed(page: str) -> None:
    outline = Outline(page)
    assert outline.open == []
    assert outline.levels.count(1) == 1
    assert all(later <= earlier + 1 for earlier, later in pairwise(outline.levels))


def test_page_refers_to_nothing_outside_itself(page: str) -> None:
    assert not re.search(r"https?://|(src|href)=\"(?!data:|#)", page)
    for target in re.findall(r'href="#([^"]+)"', page):
        assert f'id="{target}"' in page
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]+)"', page)
    assert policy.startswith("default-src &#39;none&#39;; script-src &#39;sha256-")


def test_same_arguments_give_the_same_bytes_and_not_too_many(
    small_page: str, small_sweep: "Sweep", command: str
) -> None:
    assert render(*small_sweep, command) == small_page
    assert len(small_page.encode()) < 3_000_000


def test_a_threshold_is_told_with_its_scores_on_both_parts(page: str, small_sweep: "Sweep") -> None:
    verdict = small_sweep[0][0].collision.verdict
    assert verdict.tuned is not None
    measure, default, *scores, standing = cells_of(page, "collision_threshold")
    assert (measure, default, standing) == ("F1", "0.2 m", "better: intervals apart")
    told = [score.replace("\N{NO-BREAK SPACE}", " ") for score in scores]
    assert told[2] == f"{verdict.tuned.value:g} m"
    assert told[4] == verdict.tuned.scores[Part.TEST]["F1"].text()
    assert told[5].startswith("+")
    lengths = [float(length.split()[0]) for _, length in clearance(small_sweep[0][0]).rows]
    assert sum(lengths[:4]) == pytest.approx(lengths[4], abs=0.002)


def test_a_threshold_without_support_says_why(page: str) -> None:
    second = page[page.index('<th scope="row">distance_threshold</th>') :]
    assert cells_of(second, "collision_threshold")[-1].startswith(
        "default stays: 0 contacts with hazards in the train episodes"
    )
    assert "No contact with a hazard in the test episodes, so there is no curve." in page
    assert "The test episodes have ground of one class only, so there is no figure." in page


def test_parameter_files_stand_on_the_page_as_they_are(
    page: str, small_sweep: "Sweep", command: str
) -> None:
    texts = re.findall(r"<pre id=\"file-\w+\"[^>]*>([^<]*)</pre>", page)
    assert [unescape(text) for text in texts] == [
        parameter_file(study, command) for study in small_sweep[0]
    ]


def test_the_command_is_text_and_never_markup(page: str) -> None:
    assert "<b>" not in page
    assert page.count("&lt;b&gt;tuning") == 3  # both files and the way to repeat it


@pytest.mark.parametrize(
    ("score", "expected"),
    [
        (Estimate(-0.25, -0.5, 0.125), "\N{MINUS SIGN}0.25 (\N{MINUS SIGN}0.50 to +0.12)"),
        (Estimate(0.5), "+0.50 (no interval)"),
        (Estimate(float("nan")), "\N{EN DASH}"),
    ],
)
def test_a_gain_has_a_sign_and_its_interval(score: Estimate, expected: str) -> None:
    assert _text(score, sign="+").replace("\N{NO-BREAK SPACE}", " ") == expected


def test_a_frontier_has_the_highest_recall_for_each_price() -> None:
    scores: Mapping[str, np.ndarray] = {
        FALSE_ALARMS: np.array([0.0, 5.0, 2.0, 5.0, 9.0, 4.0]),
        "recall": np.array([0.1, 0.6, 0.4, 0.7, 0.7, 0.2]),
    }
    price, recall = frontier(scores)
    assert price.tolist() == [0.0, 2.0, 5.0]
    assert recall.tolist() == [0.1, 0.4, 0.7]


def test_only_a_value_that_is_proven_is_called_tuned(small_sweep: "Sweep") -> None:
    proven = small_sweep[0][0].collision.verdict
    doubtful = replace(proven, gain={"F1": Estimate(0.1, -0.1, 0.3)})
    assert [shape["name"] for shape in levels(proven)][1].startswith("tuned 0.")
    assert [shape["name"] for shape in levels(doubtful)][1].startswith("chosen (not proven) 0.")


@pytest.mark.parametrize("number", range(len(SIGNALS)))
def test_each_class_of_ground_adds_up_to_all_of_it(number: int, small_sweep: "Sweep") -> None:
    studies, records = small_sweep
    leo, signal = Subject(studies[0], scored_records("leo", records)), SIGNALS[number]
    plot = ground_figures(leo)[f"{signal.parameter}-classes"]
    assert not isinstance(plot, str)
    assert [sum(trace["y"]) for trace in plot.figure["data"]] == pytest.approx([100.0, 100.0], abs=0.01)


@pytest.mark.parametrize("name", ["roc", "rough_terrain_threshold-roc"])
def test_values_of_thresholds_stand_on_the_curve_of_what_they_are_compared_with(
    name: str, small_sweep: "Sweep"
) -> None:
    studies, records = small_sweep
    leo = Subject(studies[0], scored_records("leo", records))
    plot = (scan_figures(leo) | ground_figures(leo))[name]
    assert not isinstance(plot, str)
    curves, marks = list[list[float]](), list[list[float]]()
    for trace in plot.figure["data"]:
        if not trace["name"].startswith("chance"):
            (marks if trace["mode"] == "markers" else curves).append([trace["x"], trace["y"]])
    assert len(marks) >= 2
    points = [np.array(curve, np.float64) for curve in curves]
    between = np.linspace(0.0, 1.0, 50)[:, None, None]  # of two points that follow each other
    each = [one[:, :-1].T * (1.0 - between) + one[:, 1:].T * between for one in points]
    dense = np.concatenate([one.reshape(-1, 2) for one in each])
    for place in marks:
        assert np.hypot(*(dense.T - place)).min() < 0.02
    assert all(np.trapezoid(y, x) > 0.5 for x, y in points)
