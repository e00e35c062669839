"""`python -m rover_metrics.social` as its user sees it."""

import csv
import json
import re
import shutil
from pathlib import Path

import pytest

from rover_metrics import social
from rover_metrics.analysis.social.comparison import make_group
from rover_metrics.analysis.social.log import read_social_log
from rover_metrics.analysis.social.page import draw_distances, draw_meetings, draw_windows
from tests.support.complaint import complaint
from tests.support.figures import described
from tests.support.snapshots import check_snapshot

FOLDERS = ("fast", "slow")
HEADER = "step,time_s,robot_x,robot_y,speed_mps,guide_actor_dist,dmin,goals_count"


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    """Two folders with two logs of 40 s: a goal every 2 s, somebody near; every 4 s, nobody near."""
    for folder, period, far in (("fast", 2, 0.4), ("slow", 4, 3.0)):
        for run in range(2):
            path = tmp_path / folder / f"{folder}_{run}.csv"
            path.parent.mkdir(exist_ok=True)
            near = [f"{far + 0.1 * (n % 3):.1f}" for n in range(41)]
            rows = [f"{n},{n}.00,{n},{run},1.00,{near[n]},{near[n]},{n // period}" for n in range(1, 41)]
            path.write_text("\n".join([HEADER, *rows, ""]))
    return tmp_path


def test_the_numbers_are_those_of_the_logs(logs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert social.main([str(logs / "fast"), str(logs / "slow"), "--json", "--window", "5"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert list(result["groups"]) == ["fast", "slow"]
    assert [run["s_per_goal"] for run in result["groups"]["fast"]["runs"]] == [2.0, 2.0]
    assert [len(group["windows"]) for group in result["groups"].values()] == [8, 4]
    assert result["groups"]["slow"]["runs"][0]["risk_s"] == 0
    assert result["differences"][1]["runs"]["p"] == pytest.approx(1 / 3)


def test_tables_and_pictures_are_as_checked(logs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = logs / "page.html"
    groups = ["$b<i>=*_1.csv", "a=*_0.csv"]
    words = [str(logs / "fast"), str(logs / "slow"), "--groups", *groups, "--window", "3"]
    assert social.main([*words, "--page", str(page), "--risk-distance", "0.55"]) == 0
    printed, written = capsys.readouterr().out, page.read_text()
    html, pictures = re.subn(r"<svg.*?</svg>", "<svg/>", written, flags=re.DOTALL)
    assert pictures == 3
    assert not re.search(r"""(?:src|href)=["']https?:|<i>""", written)
    assert social.main([*words, "--confidence-level", "0.8"]) == 0
    again = capsys.readouterr().out.partition("Differences")[2]
    read = {
        name: [read_social_log(path) for path in sorted((logs / name).iterdir())] for name in FOLDERS
    }
    made = {name: make_group(name, some, goals=3) for name, some in read.items()}
    figures = (described(draw(made)) for draw in (draw_windows, draw_distances, draw_meetings))
    text = "\n".join([printed, again, html.partition("</style>")[2], *figures])
    check_snapshot("social.txt", text.replace(str(logs), "FOLDER"))
    for goals, texts in ((25, []), (99, ["no value"] * 2)):  # a window of one group, and none at all
        figure = draw_windows({name: make_group(name, some, goals=goals) for name, some in read.items()})
        figure.draw_without_rendering()
        assert all(axes.get_position().width > 0.35 for axes in figure.axes)
        assert [text.get_text() for axes in figure.axes for text in axes.texts] == texts


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (["{0}/fast", "--groups", "quick"], 2, "has no log; the folders of the logs are: fast"),
        (["{0}/fast", "--groups", "a=*", "b=*_0.csv"], 2, "fast_0.csv is in groups a and b"),
        (["{0}/fast", "--groups", "fast", "fast"], 2, "give each group a name of its own"),
        (["{0}/empty"], 2, "there is no log (*.csv) in this folder"),
        (["{0}/none.csv"], 2, "skipped {0}/none.csv: there is no such file"),
        (["{0}/fast", "{0}/fast/none.csv"], 2, "skipped"),
        (["{0}/fast", "{0}/slow/slow_0.csv", "--groups", "fast"], 0, "slow_0.csv is in no group"),
        (["{0}/fast", "--page", "{0}/no/page.html"], 2, "cannot use"),
    ],
)
def test_mistakes_are_told_in_one_line(
    words: list[str], code: int, told: str, logs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (logs / "empty").mkdir(exist_ok=True)
    assert social.main([word.format(logs) for word in words]) == code
    error = capsys.readouterr().err
    assert told.format(logs) in error
    assert error.count("\n") == 1
    for wrong in (
        ["--window", "0"],
        ["--risk-distance", "nan"],
        ["--confidence-level", "1"],
        ["--window", "1_0"],
        ["--risk-distance", "1_0"],
    ):
        assert "is not valid; give a" in complaint(social.main, ["log.csv", *wrong], capsys)


def test_the_tables_are_rows_behind_their_titles(logs: Path, tmp_path: Path) -> None:
    assert social.main([str(logs), "--csv", str(tmp_path / "t.csv")]) == 0
    with (tmp_path / "t.csv").open(newline="") as file:
        tables = [row["table"] for row in csv.DictReader(file)]
    assert {"Runs of fast", "Runs of slow", "Groups"} <= {*tables}


def test_a_folder_is_read_with_those_below_it(logs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (logs / "fast").rename(logs / "social")
    (logs / "fast").mkdir()
    (logs / "social").rename(logs / "fast" / "social")  # where runs put them
    assert social.main([str(logs), "--json"]) == 0
    assert set(json.loads(capsys.readouterr().out)["groups"]) == {"fast", "slow"}
    shutil.copytree(logs / "fast", logs / "later" / "fast")
    assert social.main([str(logs), "--json"]) == 0
    assert "2 folders called fast are one group" in capsys.readouterr().err
