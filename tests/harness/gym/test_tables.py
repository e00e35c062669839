import re
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.gym import ENVIRONMENTS, tables

PAGE = Path(__file__).parents[3] / "docs/gym.md"
CODE = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)


def test_the_page_is_the_one_that_the_environments_make(capsys: pytest.CaptureFixture[str]) -> None:
    page = PAGE.read_text()
    assert tables.filled(page) == page, f"run {tables.COMMAND}"
    for name in ENVIRONMENTS:
        assert f"<!-- tables of {name} -->" in page
        assert f"## {name.removeprefix('RoverHarness/').removesuffix('-v0')}" in page
    assert tables.main([]) == 0
    told = capsys.readouterr().out
    for line in told.splitlines():
        assert line in page
    assert tables.tables("options") in told


def test_every_option_and_every_part_is_told_of_with_its_default() -> None:
    text = tables.tables("RoverHarness/PointNav-v0") + tables.tables("options")
    for row in (
        "| `noise` | `''` | A preset of sensor errors; \"\" for exact sensors. |",
        "| `reward` `hazard` | `-10.0` | Seconds of contact with hazards. |",
        "| `curriculum` `window` | `20` |",
        "| `lidar` | `(640,)` | 0 .. 10 | ranges of /scan [m]",
        "| 0 | -1 .. 1 | speed; 1 is 0.75 m/s, as fast as the wheels of leo turn |",
        "| `edge` | truncated: half a metre from the edge of the map |",
    ):
        assert row in text
    assert "| 1 | -3.142 .. 3.142 |" in tables.tables("RoverHarness/RoboTerrain-v0")


def test_it_writes_into_the_page_and_knows_its_environments(tmp_path: Path) -> None:
    page = tmp_path / "gym.md"
    page.write_text("a\n<!-- tables of options -->\n\nold\n<!-- end of tables -->\nb\n")
    assert tables.main(["--write", str(page)]) == 0
    head, rest = page.read_text().split("<!-- tables of options -->\n")
    assert (head, rest.startswith("| option | default | what |")) == ("a\n", True)
    assert rest.endswith("<!-- end of tables -->\nb\n")
    assert "\nold\n" not in rest
    with pytest.raises(
        UsageError, match="environment 'Chess-v0' does not exist; available: RoverHarness"
    ):
        tables.tables("Chess-v0")


@pytest.mark.parametrize("code", CODE)
def test_the_code_of_the_page_runs(code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(code, {})  # noqa: S102 - our own


def test_help_tells_how_it_is_run(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        tables.main(["--help"])
    assert capsys.readouterr().out.startswith("usage: python -m harness.gym.tables ")
