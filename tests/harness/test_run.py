import csv
import html
import json
import shlex
import sys
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.base.interrupt import StopRequest
from harness.episode.helm import Helm, Order
from harness.run import main
from harness.world.terrains import TERRAINS
from rover_metrics.errors import LogError
from rover_metrics.log.csv_log import CsvLog
from tests.support.complaint import complaint, without_progress
from tests.support.waiting import free_port


def raises(error: Exception) -> Callable[..., None]:
    """A function that raises an error."""

    def function(*_: object) -> None:
        raise error

    return function


QUICK = ["--direct", "--terrain", "flat", "--duration", "2"]


def test_direct_run_writes_csv_and_manifest(tmp_path: Path) -> None:
    summary = tmp_path / "summary.json"
    assert main([*QUICK, "--log-dir", str(tmp_path / "logs"), "--summary", str(summary)]) == 0
    (log,) = (tmp_path / "logs").glob("*.csv")
    with log.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["Timestamp"] for row in rows] == ["1", "2"]
    manifest = json.loads(log.with_suffix(".json").read_text())
    assert manifest == json.loads(summary.read_text())
    assert manifest["outcome"] == {"status": "complete", "reason": None}
    assert manifest["rows"] == 2
    assert manifest["last_row"]["Timestamp"] == 2


def test_the_line_that_a_run_keeps_gives_its_bytes_again(tmp_path: Path) -> None:
    fleet = ["--rover", "leo:a,driver=wander", "--rover", "rover_zero4wd:b,x=2,y=0,fault=imu:nan=0.5"]
    watched = ["--rate", "max", "--live", f":{free_port()}", "--live-token", "s0-secret"]
    drawn = ["--noise", "hardware", "--seed", "5", "--page", "--log-dir", str(tmp_path / "a's")]
    assert main([*QUICK, *fleet, *drawn, *watched]) == 0
    (kept,) = tmp_path.glob("*/b/*.json")
    command = json.loads(kept.read_text())["command"]
    assert f">{command}</pre>" in html.unescape(kept.with_suffix(".html").read_text())
    assert "s0-secret" not in command
    own = command.removeprefix("python -m harness.run").replace("TOKEN", "another-secret")
    assert main(shlex.split(own)) == 0
    for name in "ab":
        one, again = (log.read_bytes() for log in tmp_path.glob(f"*/{name}/*.csv"))
        assert one == again
    assert len({log.read_bytes() for log in tmp_path.glob("*/*/*.csv")}) == 2


@pytest.mark.parametrize("fleet", [[], ["--rover", "leo:a", "--rover", "leo:b,x=2,y=0"]])
def test_what_somebody_has_steered_has_no_line_that_gives_it_again(
    fleet: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    helm = Helm(None, StopRequest())
    monkeypatch.setattr("harness.cli.run_command.watched", lambda *_: nullcontext((helm, ())))
    helm.order(len(fleet) // 4, Order(reset=True))
    assert main([*QUICK, *fleet, "--log-dir", str(tmp_path)]) == 0
    kept = [json.loads(file.read_text()) for file in tmp_path.rglob("*.json")]
    assert [each["command"] for each in kept] == [None] * (1 + len(fleet) // 4)


def test_a_run_leaves_all_of_it_in_one_folder_and_says_what_went_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.view.drawing.artist", raises(UsageError("no OpenGL here")))
    hit = ["--direct", "--terrain", "posts", "--driver", "straight", "--duration", "5", "--out"]
    near = ["--start", "2.5,0"]
    assert main([*hit, str(tmp_path / "a"), *near]) == 0
    told = capsys.readouterr().out.splitlines()
    (log,) = (tmp_path / "a").glob("*.csv")
    assert {path.name for path in log.parent.iterdir()} == {
        log.with_suffix(end).name for end in (".csv", ".json", ".html")
    }
    (wrong,) = (line.removeprefix("went wrong: ") for line in told if line.startswith("went wrong: "))
    assert wrong.startswith("hit ")
    assert f"<strong>H{wrong[1:]}</strong>" in log.with_suffix(".html").read_text()
    assert told[-3:-1] == [f"page: {log.with_suffix('.html')}", "there is no picture: no OpenGL here"]
    recorded = [*near, "--record", str(tmp_path / "b" / "run.mcap")]
    assert main([*hit, str(tmp_path / "b"), "--fail-on", "hazard", *recorded]) == 1
    assert without_progress(capsys.readouterr().err) == [f"harness.run: {wrong}"]
    assert (tmp_path / "b" / "run.mcap").is_file()
    (manifest,) = (tmp_path / "b").glob("*.json")
    assert json.loads(manifest.read_text())["outcome"] == {"status": "failed", "reason": wrong}
    fleet = ["--rover", "leo:a,driver=spin,x=-6,y=6", "--rover", "leo:b,x=2.5,y=0"]
    assert main([*hit, str(tmp_path / "e"), "--fail-on", "hazard", *fleet]) == 1  # for the second
    (said,) = without_progress(capsys.readouterr().err)
    assert said.startswith("harness.run: hit ")
    assert main([*hit, str(tmp_path / "c" / "d"), "--record", str(tmp_path / "c/d/e/run.mcap")]) == 2
    assert not (tmp_path / "c").exists()


def test_a_run_with_people_has_a_social_log_and_drives_as_without(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--terrain", "flat", "--direct", "--duration", "2", "--driver", "straight"]
    people = ["--actor", "g=3,0/3,4", "--actor", "far=-15,0"]  # beyond the lidar's 10 m, or behind
    assert main([*words, "--log-dir", str(tmp_path / "a"), *people]) == 0
    (social,) = (tmp_path / "a" / "social").iterdir()
    assert f"people: {social}" in capsys.readouterr().out
    assert len(social.read_bytes().split(b"\r\n")) == 4
    (manifest,) = (tmp_path / "a").glob("*.json")
    assert json.loads(manifest.read_text())["social_log"] == str(social)
    assert main([*words, "--log-dir", str(tmp_path / "b")]) == 0
    named = ["--log-dir", str(tmp_path / "c"), *people, "--social-log", str(tmp_path / "s.csv")]
    assert [main([*words, *named, *more]) for more in ([], [], ["--overwrite"])] == [0, 2, 0]
    assert (tmp_path / "s.csv").read_bytes() == social.read_bytes()
    rows = [next((tmp_path / name).glob("*.csv")).read_text().splitlines() for name in "ab"]
    clearance = rows[0][0].split(",").index("Obstacle Clearance")
    for with_people, without in zip(*rows, strict=True):
        cells = zip(with_people.split(","), without.split(","), strict=True)
        assert {n for n, (one, other) in enumerate(cells) if one != other} <= {clearance}


def test_run_that_reaches_the_edge_keeps_its_rows_and_exits_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("physics", "health"):
        monkeypatch.setattr(f"harness.physics.{module}.EDGE_MARGIN", 19.5)
    words = ["--direct", "--terrain", "flat", "--driver", "straight", "--duration", "120"]
    assert main([*words, "--log-dir", str(tmp_path)]) == 1
    assert "harness.run: the rover reached the edge of the map at t = " in capsys.readouterr().err
    (log,) = tmp_path.glob("*.csv")
    assert len(log.read_text().splitlines()) == 1 + 1, "half a metre takes between one and two seconds"
    outcome = json.loads(log.with_suffix(".json").read_text())["outcome"]
    assert outcome["status"] == "failed"
    assert "edge of the map" in outcome["reason"]


def test_list_names_terrains_with_their_promises_robots_drivers_and_noise(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["--list"]) == 0
    listed = capsys.readouterr().out
    terrains = ("flat", "slope", "rolling", "gravel", "rocky", "washboard", "dunes", "posts", "maze")
    drivers = ("wander", "straight", "spin", "figure8", "cmd_vel", "policy:FILE.npz")
    for name in (*terrains, *drivers, "leo", "rover_zero4wd"):
        assert f"{name} " in listed
    assert {f" {name} " in listed for name in ("white", "hardware", "gazebo")} == {True}
    assert " ".join(TERRAINS["rocky"].promise.describe().split()) in " ".join(listed.split())


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--terrain", "moon"], "available: flat, slope"),
        (["--robot", "r2d2"], "available: husky, jackal, leo, rover_zero4wd"),
        (["--driver", "drunk"], "available: wander"),
        (["--duration", "nan"], "give 0.01 s or more"),
        (["--seed", "nan"], "--seed 'nan' is not valid; give a whole number"),
        (["--rate", "nan"], "--rate"),
        (["--rate", "inf"], "--rate"),
        (["--timestep", "0.007"], "nearest valid: 0.005"),
        (["--wheels", "6"], "unrecognized arguments: --wheels 6"),
        (["--direct", "--actor", "g=0,0/30,0"], "actor 'g' walks off the map at 19.60,0.00"),
        (["--direct", "--driver", "goal", "--route", "1,0/@51,7"], "route: way point"),
        (["--direct", "--actor", "none.sdf"], "cannot read none.sdf: No such file"),
        (["--direct", "--actor", "g=random:speed=0"], "speed '0' is not valid; give 0.05 to 10"),
        (
            ["--direct", "--driver", "goal", "--goal-area", "90,91,0,1"],
            "the goal area x 90 to 91, y 0 to 1 m reaches beyond the map, x -20 to 20, y -20 to 20 m",
        ),
        (
            ["--direct", "--driver", "goal", "--goal-area=-1.7e308,1.7e308,0,1"],
            "m reaches beyond the map, x -20 to 20, y -20 to 20 m; give another --goal-area",
        ),
        (
            ["--direct", "--actor", "g=random", "--social-log", "/nowhere/s.csv"],
            "there is no folder /nowhere",
        ),
        (["--out", "a"], "--out is the folder of the log too; leave out --log-dir"),
        (["--fail-on", "rain"], "--fail-on"),
        (["--page", "a.pdf"], "name a file that ends in .html, .htm"),
        (["--json", "-"], "'-' is not valid: no file is standard input or output"),
        (["--summary", "/nowhere/x.json"], "there is no folder /nowhere; create it first"),
    ],
)
def test_bad_argument_is_one_line_that_names_what_is_valid(
    arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert expected in complaint(main, [*arguments, "--log-dir", str(tmp_path)], capsys)
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_is_full_is_told_of_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def no_row(*_: object) -> None:
        raise LogError("cannot write a row: No space left on device")

    def no_manifest(*_: object) -> None:
        raise UsageError("cannot write the summary: No space left on device")

    monkeypatch.setattr(CsvLog, "write", no_row)
    monkeypatch.setattr("harness.cli.run_command.write_manifest", no_manifest)
    assert main([*QUICK, "--log-dir", str(tmp_path)]) == 1
    told = "harness.run: cannot write a row: No space left on device"
    assert without_progress(capsys.readouterr().err) == [told]


def test_file_where_the_log_folder_should_be_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "logs").write_text("not a folder")
    text = complaint(main, [*QUICK, "--log-dir", str(tmp_path / "logs")], capsys)
    assert "a file stands where a folder should be" in text
    text = complaint(main, [*QUICK, "--log-dir", "/proc/logs"], capsys)
    assert "cannot create a log in /proc/logs" in text


@pytest.mark.usefixtures("ros_domain")
def test_a_folder_whose_name_no_text_of_ros_holds_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    words = ["--terrain", "flat", "--duration", "1", "--log-dir", f"{tmp_path}/bad\udcff"]
    assert "has a name that is no UTF-8" in complaint(main, words, capfd)
    assert not list(tmp_path.iterdir())
    assert main([*words, "--direct"]) == 0


def test_missing_rclpy_names_the_extra_and_direct(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    for module in [name for name in sys.modules if name.startswith("harness.ros.")]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "rclpy", None)
    text = complaint(main, ["--terrain", "flat", "--log-dir", str(tmp_path / "new")], capsys)
    assert list(tmp_path.iterdir()) == []
    assert "pip install 'rover-harness[ros]'" in text
    assert "--direct" in text


def test_each_rover_of_a_fleet_has_every_file_under_its_name(tmp_path: Path) -> None:
    (params := tmp_path / "p.yaml").write_text("/**: {ros__parameters: {gravity: 9.7}}\n")
    fleet = "--rover leo:a --rover leo:b,x=3,y=0 --actor p=2,1/2,-1 --lidar-beams 8"
    tmp_path /= "new"
    files = f"--log-dir {tmp_path} --params {params} --json {tmp_path}/s.json --page {tmp_path}/p.html"
    files += f" --record {tmp_path}/all.mcap"
    assert main(f"--terrain flat --duration 1.2 --direct {fleet} {files}".split()) == 0
    first, second = (next((tmp_path / name).rglob("social_log_*.csv")).read_text() for name in "ab")
    assert first != second
    for name, other in ("ab", "ba"):
        told = json.loads((tmp_path / f"s_{name}.json").read_text())
        log = Path(told["log"])
        assert (log.parent, told["params"]) == (tmp_path / name, str(params))
        assert told["recording"] == f"{tmp_path}/all.mcap"
        assert told == json.loads(log.with_suffix(".json").read_text())
        assert f'"name":"{other}"' in (tmp_path / f"p_{name}.html").read_text()  # its way, on the map
