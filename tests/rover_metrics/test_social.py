"""`python -m rover_metrics.social` as its user sees it."""

import json
import re
from pathlib import Path

import pytest

from rover_metrics import social

HEADER = "step,time_s,robot_x,robot_y,speed_mps,guide_actor_dist,dmin,goals_count"


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    """Two folders with two logs of 40 s: a goal every 2 s, somebody near; every 4 s, nobody near."""
    for folder, period, far in (("fast", 2, 0.4), ("slow", 4, 3.0)):
        for run in range(2):
            path = tmp_path / folder / f"{folder}_{run}.csv"
            path.parent.mkdir(exist_ok=True)
            rows = [f"{n},{n}.00,{n},{run},1.00,{far},{far},{n // period}" for n in range(1, 41)]
            path.write_text("\n".join([HEADER, *rows, ""]))
    return tmp_path


def test_folders_are_groups_and_the_numbers_are_those_of_the_logs(
    logs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert social.main([str(logs / "fast"), str(logs / "slow"), "--json", "--window", "5"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert list(told["groups"]) == ["fast", "slow"]
    assert [run["s_per_goal"] for run in told["groups"]["fast"]["runs"]] == [2.0, 2.0]
    assert told["groups"]["fast"]["windows"] == [[2.0, 2.0]] * 8
    assert told["groups"]["slow"]["runs"][0]["risk_s"] == 0
    assert [each["runs"]["p"] for each in told["differences"]] == pytest.approx([1 / 3, 1 / 3])


def test_groups_by_pattern_the_tables_and_the_page(
    logs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = logs / "page.html"
    groups = ["$b<i>=*_1.csv", "a=*_0.csv"]
    words = [str(logs / "fast"), str(logs / "slow"), "--groups", *groups, "--window", "3"]
    assert social.main([*words, "--page", str(page)]) == 0
    told = capsys.readouterr().out
    assert "Risk seconds a goal, $b<i> and a" in told
    html = page.read_text()
    assert html.count("<svg") == 3
    assert "&lt;i&gt;" in html
    assert "<i>" not in html
    assert not re.search(r"""(?:src|href)=["']https?:""", html)


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (
            ["{0}/fast", "--groups", "quick"],
            2,
            "group 'quick' has no log; the folders of the logs are: fast",
        ),
        (["{0}/fast", "--groups", "a=*", "b=*_0.csv"], 2, "fast_0.csv is in groups a and b"),
        (["{0}/fast", "--groups", "a", "a"], 2, "give each group a name of its own"),
        (["{0}"], 2, "there is no log (*.csv) in this folder"),
        (["{0}/none.csv"], 1, "skipped {0}/none.csv: there is no such file"),
        (["{0}/fast", "{0}/fast/none.csv"], 1, "skipped"),
        (["{0}/fast", "{0}/slow/slow_0.csv", "--groups", "fast"], 0, "slow_0.csv is in no group"),
        (["{0}/fast", "--page", "{0}/no/page.html"], 2, "cannot use"),
    ],
)
def test_mistakes_are_told_in_one_line(
    words: list[str], code: int, told: str, logs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert social.main([word.format(logs) for word in words]) == code
    error = capsys.readouterr().err
    assert told.format(logs) in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    "words", [["--window", "0"], ["--risk-distance", "nan"], ["--confidence-level", "1"]]
)
def test_options_are_checked(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        social.main(["log.csv", *words])
    assert "is not valid; give a" in capsys.readouterr().err
