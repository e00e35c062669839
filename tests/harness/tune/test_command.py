"""The command: python -m harness.tune."""

import json
from pathlib import Path

import pytest

from harness.tune import __main__ as tune
from tests.support.complaint import complaint

SHORT = ["--robot", "leo", "--episodes", "4", "--duration", "2", "--jobs", "1", "--driver", "spin"]
FILES = ("leo.yaml", "scores.json", "report.html")

Capture = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def first_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[int, Path]:
    """A sweep far too short to support a threshold."""
    folder = tmp_path_factory.mktemp("tuning")
    return tune.main([*SHORT, "--out", str(folder)]), folder


def test_data_that_support_nothing_say_why(first_run: tuple[int, Path], capsys: Capture) -> None:
    exit_code, folder = first_run
    again = tune.main([*SHORT, "--out", str(folder)])
    assert exit_code == again == 1
    complaints = capsys.readouterr().err.splitlines()
    why = "0 contacts with hazards in the train episodes; 10 are needed"
    assert complaints[0] == f"harness.tune: leo: no value for collision_threshold, {why}"
    assert len(complaints) == 7
    text = (folder / "leo.yaml").read_text()
    assert "collision_threshold:" not in text
    sweep = json.loads((folder / "sweep.json").read_text())
    assert {each["driver"] for each in sweep["episodes"].values()} == {"ram", "spin"}
    assert "collision_threshold stays at 0.2 m: 0 contacts" in text


def test_a_second_run_gives_the_same_bytes(first_run: tuple[int, Path], tmp_path: Path) -> None:
    _, folder = first_run
    tune.main([*SHORT, "--out", str(tmp_path)])
    names = {str(path.relative_to(folder)) for path in folder.rglob("*.*")}
    assert set(FILES) < names
    for name in sorted(names):
        assert (folder / name).read_bytes() == (tmp_path / name).read_bytes(), name


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--robot mars", "robot 'mars' does not exist; available: husky, jackal, leo, rover_zero4wd"),
        ("--episodes 1", "1 episode will not do"),
        ("--duration 0", "duration 0 s is not valid"),
        ("--driver fly", "driver 'fly' does not exist; available: wander"),
        ("--seed -1", "seed -1 is not valid"),
        ("--backend slurm", "local, ray://HOST:PORT, dask:tcp://HOST:PORT"),
        ("--out /proc/tuning", "choose another --out"),
        ("--robt leo", "see --help"),
    ],
)
def test_a_known_mistake_is_one_line_and_exit_code_2(
    words: str, message: str, tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    told = complaint(tune.main, words.split(), capsys)
    assert told.startswith("harness.tune: ")
    assert message in told
    assert list(tmp_path.iterdir()) == []


def test_another_sweeps_folder_is_refused(first_run: tuple[int, Path], capsys: Capture) -> None:
    _, folder = first_run
    before = {path: path.read_bytes() for path in folder.rglob("*.*")}
    exit_code = tune.main([*SHORT, "--seed", "1", "--out", str(folder)])
    assert exit_code == 2
    assert "holds another sweep's files" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in folder.rglob("*.*")} == before
