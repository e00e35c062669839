"""The page of a suite: what failed, how to see it, and figures with the numbers of the runs."""

import json
import re
from pathlib import Path
from typing import Any

from harness.scenario.comparison import comparisons_of
from harness.scenario.page.page import render
from harness.scenario.verdict import Attempt, Measured, verdicts_of
from tests.harness.scenario.conftest import MakeCases
from tests.support.snapshots import check_snapshot

EXPECT = "{truth.speed: {over: mean, min: 1, max: 3}, truth.slip: {over: share, max: 1, share: 0.5}}"


def figures(page: str) -> dict[str, Any]:
    found = re.search(r'id="figures">(.*?)</script>', page)
    assert found
    read: dict[str, Any] = json.loads(found[1])
    return read


def shown(page: str) -> str:
    """The page without scripts, styles and what differs between versions."""
    return re.sub(r"<(script|style).*?</\1>|<meta.*?>|rover-harness [^<]*", "", page, flags=re.DOTALL)


def test_a_red_suite_tells_first_what_failed_where_and_how_to_see_it_again(
    make_cases: MakeCases, tmp_path: Path
) -> None:
    cases = make_cases(EXPECT, "seeds: 2\nmatrix: {difficulty: [0, 1]}")
    kept = tmp_path / "runs/two[0.0-1]/run.html"
    reason = "truth.speed: mean 3.5 m/s > 3 m/s"
    attempts = [Attempt(case, measured=(Measured(2.0, "m/s"), Measured(0.75))) for case in cases]
    attempts[1] = Attempt(
        cases[1], (reason,), measured=(Measured(3.5, "m/s"), Measured(0.25)), kept=(kept,)
    )
    (broken,) = make_cases(EXPECT, "noise: white", name="other")
    verdicts = verdicts_of([*attempts, Attempt(broken, error="no <disk>")])
    page = render([comparisons_of(verdict) for verdict in verdicts], tmp_path / "out/page.html")
    assert 'href="../runs/two%5B0.0-1%5D/run.html"' in page
    text = shown(page).replace(str(tmp_path), "FOLDER")
    check_snapshot("suite.html.txt", re.sub(r"[^ ]*/two.scenario.yaml", "two.scenario.yaml", text))
    drawn = figures(page)
    assert set(drawn) == set(re.findall(r'class="plot" id="([^"]+)"', page))
    good, bad, mean = drawn["scenario-0-0"]["data"]
    assert (good["x"], good["y"]) == ([2.0, 2.0, 2.0], [-0.15, 0.85, 1.15])
    assert (bad["x"], bad["y"], bad["customdata"]) == ([3.5], [0.15], [1])
    assert (mean["x"], mean["y"]) == ([2.75, 2.0], [0, 1])
    layout = drawn["scenario-0-0"]["layout"]
    assert [(line["name"], line["x0"]) for line in layout["shapes"]] == [
        ("at least 1 m/s", 1.0),
        ("at most 3 m/s", 3.0),
    ]
    low, high = layout["xaxis"]["range"]
    reach = mean["error_x"]["array"][0]
    assert low < 2.75 - reach < 2.75 + reach < high
    assert layout["yaxis"]["ticktext"] == ["0.0", "1.0"]
    share = drawn["scenario-0-1"]["layout"]
    assert [(line["name"], line["x0"]) for line in share["shapes"]] == [("at least 0.5", 0.5)]
    assert drawn["scenario-0-passed"]["data"][0]["x"] == [50.0, 100.0]


def test_a_green_suite_says_so_and_is_the_same_bytes_each_time(
    make_cases: MakeCases, tmp_path: Path
) -> None:
    cases = make_cases(EXPECT, "seeds: 3\npass_rate: {min: 0.5}")
    attempts = [
        Attempt(case, wall_s=index, measured=(Measured(None), Measured(None)))
        for index, case in enumerate(cases)
    ]
    attempts[0] = Attempt(cases[0], ("truth.speed: 9 > 3",))
    (verdict,) = verdicts_of(attempts)
    page = render([comparisons_of(verdict)], tmp_path / "page.html")
    assert "<h1>1 scenario: passed</h1>" in page
    assert "What went wrong" not in page
    assert figures(page)["scenario-0-passed"]["layout"]["shapes"][0]["x0"] == 50.0
    empty = figures(page)["scenario-0-0"]
    assert empty["data"] == []  # no run had a value
    low, high = empty["layout"]["xaxis"]["range"]
    assert low < 1.0  # but it had limits
    assert high > 3.0
    again = [Attempt(one.case, one.breaches, wall_s=9.0, measured=one.measured) for one in attempts]
    assert render([comparisons_of(*verdicts_of(again))], tmp_path / "page.html") == page
