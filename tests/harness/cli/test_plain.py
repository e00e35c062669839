"""Names from strangers' files are printed as they are, or with a ? where they would move the cursor."""

import io
import shutil
from pathlib import Path

import numpy as np
import pytest
from rich.table import Table

from harness import robot, run
from harness.robots.content import MODELS_DIR
from harness.scenario import __main__ as scenario
from rover_metrics.sheet.console import PlainConsole

HOSTILE = ("[/b]", "[link=http://x]a[/link]", "[red", ":warning:", "a\x1b[2J\x07b", "[/]")


@pytest.mark.parametrize("name", HOSTILE)
def test_whatever_prints_a_name_prints_it_as_text(name: str) -> None:
    shown = io.StringIO()
    console = PlainConsole(file=shown, width=100, force_terminal=True, color_system=None)
    table = Table(name, title=name)
    table.add_row(name)
    console.print(name, table, sep="\n")
    console.rule(name)
    with console.status(name):
        pass
    plain = name.replace("\x1b", "?").replace("\x07", "?")
    assert shown.getvalue().count(plain) >= 5
    assert "\x1b[2J" not in shown.getvalue()


@pytest.fixture
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The present folder: a rover `[red]m` and a map `d[/x].npy` in it."""
    monkeypatch.chdir(tmp_path)
    rover = shutil.copytree(MODELS_DIR / "leo", tmp_path / "[red]m")
    (rover / "leo.xml").write_text(
        (rover / "leo.xml").read_text().replace('model="leo"', 'model="[/b]"')
    )
    told = (rover / "rover.yaml").read_text()
    (rover / "rover.yaml").write_text(told.replace("Leo Rover 1.8", "[/b] [link=http://x]Leo[/link]"))
    (tmp_path / "d[").mkdir()
    np.save("d[/x].npy", np.zeros((80, 80)))


def test_a_pipe_takes_wide_tables_unless_it_is_told_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    cell = "/rover1/odometry/" * 6
    for columns, is_whole in ((None, True), ("60", False)):
        if columns:
            monkeypatch.setenv("COLUMNS", columns)
        console = PlainConsole(file=io.StringIO())
        table = Table("topic")
        table.add_row(cell)
        console.print(table)
        assert (cell in console.file.getvalue()) == is_whole  # type: ignore[attr-defined]


@pytest.mark.usefixtures("_folder")
def test_a_run_of_a_rover_and_a_map_of_such_names_tells_them_as_they_are(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["--terrain", "d[/x].npy", "--terrain-size", "20", "--terrain-height", "0"]
    words += ["--rover", "[red]m:a", "--duration", "1", "--log-dir", "l[/b]"]
    assert run.main(["--direct", *words]) == 0
    shown = capsys.readouterr().out
    assert "a, a [red]m" in shown
    assert "/l[/b]/a/metrics_log_" in shown


@pytest.mark.usefixtures("_folder")
def test_the_check_of_such_a_rover_and_a_scenario_tell_its_name(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.validate.checkup.check_up", lambda _: [])
    assert robot.main(["check", "[red]m"]) == 0
    assert "[/b] [link=http://x]Leo[/link]: 5.5 kg" in " ".join(capsys.readouterr().out.split())
    Path("s[red].scenario.yaml").write_text(
        "about: a\nterrain: flat\nrobot: '[red]m'\nduration: 1\nexpect: {truth.x: {min: 9}}\n"
    )
    assert scenario.main(["s[red].scenario.yaml", "--jobs", "1", "--out", "o"]) == 1
    assert "failed s[red][0]" in capsys.readouterr().out
