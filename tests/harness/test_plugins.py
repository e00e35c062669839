"""Plug-ins: a package with one of each thing, installed, and the same things out of its file."""

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from harness.run import main
from rover_metrics.errors import run_program
from rover_metrics.plugins import KINDS, PluginError, Table
from tests.support.complaint import complaint
from tests.support.documents import ROOT
from tests.support.rovers import LEO

PACKAGE = ROOT / "examples/plugin"
PARTS = PACKAGE / "my_rover_parts.py"
NAMES = {
    "terrains": "crater",
    "soils": "regolith",
    "drivers": "weave",
    "sensors": "inclinometer",
    "faults": "halved",
    "columns": "climb",
}
INSTALLED = (
    "--terrain crater --soil regolith --driver weave --sensors inclinometer --columns climb "
    "--fault inclinometer:halved"
)
OF_FILE = (
    "--terrain {0}:Crater --soil {0}:REGOLITH --driver {0}:Weave --sensors {0}:INCLINOMETER "
    "--columns {0}:Climb --fault inclinometer:{0}:HALVED"
)
SCENARIO = """about: near the middle
terrain: crater
driver: weave
duration: 2
expect:
  from_origin: {max: 5.0}
"""
IN_GYM = """
import gymnasium, harness.gym
own = {"terrain": "crater", "reward_fn": "calm", "observe_fn": "heading", "terminate_fn": "brief"}
env = gymnasium.make("RoverHarness/PointNav-v0", **own)
seen, _ = env.reset(seed=1)
steps = 1 + next(n for n in range(99) if env.step(env.action_space.sample())[2])
env.reset(seed=1)
_, reward, _, _, info = env.step(env.action_space.sample())
terms = info["reward_terms"]
print(list(terms), abs(reward - sum(terms.values())) < 1e-9, seen["heading"].shape, steps)
"""


def said(code: str, surroundings: Mapping[str, str]) -> str:
    """What a program says."""
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, env=surroundings, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def logged(folder: Path) -> tuple[bytes, dict[str, dict[str, str]]]:
    """The log of a run and the plug-ins in its manifest."""
    (log,) = folder.glob("*.csv")
    return log.read_bytes(), json.loads(log.with_suffix(".json").read_text())["plugins"]


def test_a_part_without_a_word_about_it_is_listed_by_its_name_and_one_without_effect_with_the_reason(
    tmp_path: Path,
) -> None:
    (tmp_path / "bare.py").write_text("def still(truth, action):\n    return 0.0\n")
    points = "[rover_harness.rewards]\nstill = bare:still\n[rover_harness.drivers]\nwander = bare:W\n"
    for name in ("bare", "other"):
        (about := tmp_path / f"{name}-1.dist-info").mkdir()
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n")
        (about / "entry_points.txt").write_text(f"{points}[rover_harness.robot]\n{name} = bare:R\n")
    surroundings = os.environ | {"PYTHONPATH": str(tmp_path), "COLUMNS": "200"}
    lines = said("from harness.run import main; main(['--list'])", surroundings)
    assert len(re.findall(r"rewards: still \(\w+ 1\)\n", lines)) == 1
    assert (
        len(re.findall(r"rewards: 'still' of \w+ 1 is not used, as one of \w+ 1 has that", lines)) == 1
    )
    assert lines.count("1 is not used, as one of ours has that name; rename it") == 2
    assert "rover_harness.robot is no table, so nothing has 'bare' of bare 1, 'other' of" in lines


def test_an_installed_package_is_there_for_runs_scenarios_and_environments_and_a_file_gives_the_same(
    tmp_path: Path,
) -> None:
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*pip, "--target", str(tmp_path / "package"), str(PACKAGE)], check=True)
    quick = ["--direct", "--duration", "2", "--log-dir"]
    words = [*INSTALLED.split(), *quick, str(tmp_path / "installed")]
    (scenario := tmp_path / "a.scenario.yaml").write_text(SCENARIO)
    code = f"from harness.run import main; main(['--list']); main({words})\n"
    code += f"from harness.scenario.__main__ import main; main([{str(scenario)!r}])"
    has_gym = find_spec("gymnasium") is not None
    surroundings = os.environ | {"PYTHONPATH": str(tmp_path / "package")}
    listed = said(code + IN_GYM * has_gym, surroundings)
    assert "1 of 1 scenario passed" in listed
    assert ("['progress', 'tilt', 'effort'] True (2,) 20" in listed) == has_gym
    assert all(f" {kind}: " in listed for kind in KINDS)
    assert all(f" {kind}: {name}, " in listed for kind, name in NAMES.items())
    assert main([*OF_FILE.format(PARTS).split(), *quick, str(tmp_path / "file")]) == 0
    (one, sources), (other, of_file) = logged(tmp_path / "installed"), logged(tmp_path / "file")
    assert one == other
    assert one.splitlines()[0].endswith(b",Climb [m]")
    assert sources.keys() == {f"{kind} {name}" for kind, name in NAMES.items()}
    assert {source["from"] for source in sources.values()} == {"my-rover-parts 0.1"}
    hashes = [source["sha256"] for source in (*sources.values(), *of_file.values())]
    assert len(set(hashes)) == 1
    robot, sensor = shutil.copytree(LEO.folder, tmp_path / "mine"), f"{PARTS}:INCLINOMETER"
    with (robot / "rover.yaml").open("a") as rover:
        rover.write(f"sensors: [{{kind: '{sensor}', name: lean}}]\n")
    for number, more in enumerate(([], ["--sensors", "lean"])):
        folder = tmp_path / f"carried{number}"
        assert (
            main(["--robot", str(robot), *more, "--direct", "--duration", "1", "--log-dir", str(folder)])
            == 0
        )
        assert logged(folder)[1][f"sensors {sensor}"]["sha256"] == hashes[0]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--terrain", f"{PARTS}:Weave"], "is not a subclass of harness.world.terrain.Terrain"),
        (["--driver", "none.py:Mine"], "drivers: 'none.py:Mine' cannot be loaded: FileNotFoundError"),
        (["--driver", f"{PARTS}:Mine"], "REGOLITH, Weave, Tilt"),
        (["--driver", f"{PARTS}:StepTruth"], "is not a class with summary, senses, command"),
        (["--columns", "none"], "columns 'none' does not exist; available: none"),
    ],
)
def test_a_plugin_that_does_not_fit_is_one_line(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told in complaint(main, ["--direct", *words], capsys)


@pytest.mark.parametrize(
    ("line", "instead", "told"),
    [
        ('"std_msgs/msg/Float64"', '"std_msgs/msg/Float46"', "give one such as std_msgs/msg/Float64"),
        ('"tilt", "std', '"tilt angle", "std', "is not a harness.sensors.table.SensorRow"),
        ('"tilt", "std', '"/tilt", "std', "no slash before them"),
        ("data: float", "tilt: float", "call them as the message does: data"),
    ],
)
def test_a_sensor_whose_samples_fill_no_message_is_one_line(
    line: str, instead: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (file := tmp_path / "parts.py").write_text(PARTS.read_text().replace(line, instead))
    words = ["--sensors", f"{file}:INCLINOMETER", "--record", str(tmp_path / "run.mcap")]
    assert told in complaint(main, ["--direct", *words, "--log-dir", str(tmp_path)], capsys)


@pytest.mark.parametrize(
    ("option", "value", "line"),
    [
        ("--driver", "{}:Weave", "rate = 0.5 *"),
        ("--sensors", "{}:INCLINOMETER", "up = self.pose"),
        ("--columns", "{}:Climb", "return (self._climb,"),
        ("--fault", "imu:{}:HALVED", "0.5 * v"),
    ],
)
@pytest.mark.parametrize("through", ["--direct", "--rate=max"])
@pytest.mark.usefixtures("ros_domain")
def test_a_plugin_that_raises_fails_the_run_in_one_line_that_names_its_own(
    through: str, option: str, value: str, line: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    if through != "--direct":
        pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    file = tmp_path / "parts.py"
    broken = line.replace("0.5 * v", "[][1]") if option == "--fault" else f"[][1]; {line}"
    file.write_text(PARTS.read_text().replace(line, broken))
    words = [through, "--duration", "2", "--log-dir", str(tmp_path), option, value.format(file)]
    assert main(words) == 1
    (told,) = [row for row in capfd.readouterr().err.splitlines() if "a plug-in failed" in row]
    assert f"{file}, line " in told
    assert "IndexError" in told
    (log,) = tmp_path.glob("*.csv")
    outcome = json.loads(log.with_suffix(".json").read_text())["outcome"]
    assert (outcome["status"], outcome["reason"] in told) == ("failed", True)


@pytest.mark.parametrize(
    ("option", "value", "line", "instead", "told"),
    [
        ("--driver", "{}:Weave", "return Twist(", "return (", "Weave gives ("),
        ("--driver", "{}:Weave", "cruise_speed, rate", "cruise_speed, None", "Weave gives Twist("),
        (
            "--driver",
            "{}:Weave",
            "def command(self, observation",
            "def command(self, *, o",
            "Weave.command()",
        ),
        ("--sensors", "{}:INCLINOMETER", "return Tilt(", "return (", "Inclinometer gives ("),
        (
            "--sensors",
            "{}:INCLINOMETER",
            "time_ns, self.name",
            "time_ns, ''",
            "Inclinometer gives Tilt(",
        ),
        ("--sensors", "{}:INCLINOMETER", "math.acos(", "(lambda a: [a])(", "Tilt gives Tilt("),
        ("--columns", "{}:Climb", "return (self._climb,", "return (self._climb, 1.0", "Climb gives ("),
        ("--columns", "{}:Climb", "return (self._climb,)", "return self._climb", "Climb gives 0"),
        ("--columns", "{}:Climb", "stamp_ns: int, position", "position", "Climb.add_pose()"),
        ("--fault", "imu:{}:HALVED", "0.5 * v", "None", "<lambda> gives None, not 3 numbers"),
        ("--fault", "imu:{}:HALVED", "lambda v, _, __", "lambda v", "<lambda>() takes 1 "),
        ("--driver", "{}:Weave", "return Twist(", "raise SystemExit(", "SystemExit: "),
        ("--driver", "{}:Weave", "self._rover = context.rover", "raise SystemExit", "SystemExit: "),
        (
            "--sensors",
            "{}:INCLINOMETER",
            "slots=True)\nclass Tilt:",
            """repr=False)
class Tilt:
    __getattribute__ = lambda self, name: object.__getattribute__(self, name.strip("d"))""",
            "AttributeError: ",
        ),
        ("--terrain", "{}:Crater", "rng: np.random.Generator, /", "/", "Crater._heights()"),
        (
            "--terrain",
            "{}:Crater",
            "def _heights",
            "obstacles = lambda s, *_: None\n    def _heights",
            "Crater gives None",
        ),
    ],
)
def test_a_plugin_that_gives_or_takes_what_it_must_not_is_one_line(
    option: str,
    value: str,
    line: str,
    instead: str,
    told: str,
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
) -> None:
    text = PARTS.read_text()
    assert line in text
    (file := tmp_path / "parts.py").write_text(text.replace(line, instead))
    words = ["--direct", "--terrain=flat", "--duration=1", "--log-dir", str(tmp_path)]
    assert main([*words, "--record", str(tmp_path / "run.mcap"), option, value.format(file)]) == 1
    (row,) = [row for row in capfd.readouterr().err.splitlines() if "a plug-in failed" in row]
    assert row.partition(str(file))[2].startswith((f": {told}", ", line "))
    assert told in row


def test_a_plugin_that_raises_in_any_other_program_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (file := tmp_path / "mine.py").write_text("def mine():\n    return [][1]\n")
    work = Table[Any]("works", {}, callable, "a work")[f"{file}:mine"]
    assert run_program("replay", work) == 1
    (told,) = capsys.readouterr().err.splitlines()
    assert f"{file}, line 2, in mine: return [][1]: IndexError: " in told
    with pytest.raises(ZeroDivisionError):
        run_program("replay", lambda: 1 // 0)


def test_a_file_that_breaks_is_named_and_loaded_anew(tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    table = Table[int]("numbers", {"one": 1}, lambda value: value > 0, "a number")
    for wrong in ("RuntimeError('two\\nlines')", "SystemExit('two\\nlines')"):
        file.write_text(f"raise {wrong}")
        with pytest.raises(PluginError, match=r"cannot be loaded: \w+: two[?]lines$"):
            table[f"{file}:two"]
    file.write_text("two, three = 2, '3'")
    assert table[f"{file}:two"] == 2
    with pytest.raises(PluginError, match="is not a number"):
        table[f"{file}:three"]
    assert (list(table), table["one"], table.source("one")) == (["one"], 1, None)
    assert "three" not in table
