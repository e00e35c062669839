"""What users import and type first: the API's page and the first plot's say what is so."""

import ast
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import tomllib

import harness
import rover_metrics
from harness import Batch, Run, run_episode
from harness.cli.options import parse_run
from harness.run import main
from rover_metrics import COLUMNS, Settings
from rover_metrics.analysis.options import parse

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs/api.md").read_text()
PACKAGES = {"harness": harness, "rover_metrics": rover_metrics}
HEAVY = {"numpy", "mujoco", "numba", "pandas", "matplotlib", "rclpy", "rich"}


@pytest.mark.parametrize("name", PACKAGES)
def test_the_page_the_types_and_the_package_name_the_same(name: str) -> None:
    package = PACKAGES[name]
    tree = ast.parse(Path(str(package.__file__)).read_text())
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    typed = {alias.name: str(node.module) for node in imports for alias in node.names}
    for beside in ("TYPE_CHECKING", "__version__"):
        typed.pop(beside, None)
    _, _, table = PAGE.partition(f"| from `{name}` |")
    named = set(re.findall(r"`(\w+)`", table.partition("\n\n")[0]))
    assert typed == package._PLACES
    assert typed
    assert sorted(typed) == sorted(package.__all__)
    assert set(package.__all__) <= named
    assert (Path(str(package.__file__)).parent / "py.typed").read_text() == ""
    for public, place in typed.items():
        assert getattr(package, public) is getattr(sys.modules[place], public)


def test_an_episode_from_python_has_the_settings_and_observers_it_is_given(tmp_path: Path) -> None:
    class Counter:
        batches = 0

        def take(self, _: Batch) -> None:
            self.batches += 1

    counter, settings = Counter(), Settings(extended_columns=True)
    config = Run.of(terrain="flat", duration=1.0)
    result = run_episode(config, tmp_path / "new", observers=[counter], settings=settings)
    assert counter.batches == 20  # of 50 ms
    assert result.failure is None
    assert result.log_path is not None
    assert result.log_path.parent == tmp_path / "new"
    header = result.log_path.read_text().partition("\n")[0]
    assert len(header.split(",")) > len(COLUMNS) == 12
    told = json.loads(result.log_path.with_suffix(".json").read_text())
    assert (told["arguments"]["terrain"], told["arguments"]["seed"]) == ("flat", config.seed)
    assert told["outcome"]["status"] == "complete"


def test_a_name_that_is_not_public_is_refused_with_those_that_are() -> None:
    with pytest.raises(AttributeError, match=r"no attribute 'Episod'; public: Batch, Episode, "):
        _ = harness.Episod
    with pytest.raises(AttributeError, match=r"'rover_metrics' has no attribute 'x'; public: COLUMNS, "):
        _ = rover_metrics.x


def test_importing_a_package_loads_nothing_that_takes_long() -> None:
    program = "import sys, harness, rover_metrics; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not HEAVY & set(loaded.stdout.split())


def test_the_code_of_the_page_runs_and_gives_the_bytes_of_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    first, samples, metrics = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(list(filter(None, first.splitlines()))) <= 15
    names: dict[str, object] = {}
    exec(first.replace("duration=20.0", "duration=2.0"), names)  # noqa: S102 - ours
    assert (tmp_path / "clearance.png").read_bytes().startswith(b"\x89PNG")
    names["plt"].close(names["figure"])  # type: ignore[attr-defined]
    words = ["--direct", "--robot", "leo", "--terrain", "rocky", "--seed", "0", "--duration", "2"]
    assert main([*words, "--log-dir", "command"]) == 0
    (ours,), (theirs,) = (list((tmp_path / place).glob("*.csv")) for place in ("logs", "command"))
    assert ours.read_bytes() == theirs.read_bytes()
    capsys.readouterr()
    exec(samples, {})  # noqa: S102
    nearest, path = map(float, re.findall(r"[\d.]+(?= m)", capsys.readouterr().out))
    assert 0.15 <= nearest < 10.0  # what the lidar can see
    assert 0.0 < path < 2.0 * 1.0  # at most what Leo drives in 2 s
    exec(metrics, {})  # noqa: S102
    assert "'Total Collisions': 1" in capsys.readouterr().out


def test_the_commands_of_the_first_plot_are_understood(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (ROOT / "docs/first_plot.md").read_text()
    blocks = "\n".join(re.findall(r"```sh\n(.*?)```", text, re.DOTALL))
    given = [shlex.split(line, comments=True) for line in blocks.splitlines() if line[:6] == "rover-"]
    for folder in ("logs", "zero"):  # which the shell fills in
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "*.csv").write_text("Timestamp\n")
    monkeypatch.chdir(tmp_path)
    understood = {"rover-run": parse_run, "rover-analyze": parse}
    options = [understood[program](words) for program, *words in given]
    assert len(options) == 5 == len([program for program, *_ in given])
    brought = set(re.findall(r"^\| (`.*?`) \|", text.partition("## Extras")[2], re.MULTILINE))
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert {word for cell in brought for word in re.findall(r"`(\w+)`", cell)} == set(extras)
