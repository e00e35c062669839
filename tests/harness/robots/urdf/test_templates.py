"""Rovers of the templates: what they say they are, and nothing odd about them."""

from pathlib import Path

import pytest

from harness.robot import main
from harness.robots.reading import read_rover
from harness.robots.urdf.templates import TEMPLATES
from harness.validate.checkup import check_up
from tests.support.complaint import complaint

WHEELS = {"skid4": 4, "skid6": 6, "rocker": 4, "ackermann": 4}


@pytest.mark.parametrize("name", TEMPLATES)
def test_a_rover_of_a_template_drives_and_nothing_about_it_is_odd(name: str, tmp_path: Path) -> None:
    folder = tmp_path / name
    assert main(["new", "mine", "--template", name, "--out", str(folder)]) == 0
    assert {path.name for path in folder.iterdir()} == {
        *("mine.urdf", "mine.xml", "rover.yaml", "rover.schema.json")
    }
    rover = read_rover(folder)
    assert len(rover.wheel_joints) == WHEELS[name]
    assert rover.steers is TEMPLATES[name].steers
    checks = check_up(rover)
    assert [check.quantity for check in checks if not check.passed] == []
    again = tmp_path / "again"
    assert main(["new", "again", "--from", str(folder / "mine.urdf"), "--out", str(again)]) == 0
    assert read_rover(again).wheelbase == pytest.approx(rover.wheelbase)


def test_a_template_or_a_file_is_named_not_both(capsys: pytest.CaptureFixture[str]) -> None:
    assert "choose from" in complaint(main, ["new", "mine", "--template", "legs"], capsys)
    both = ["new", "mine", "--template", "skid4", "--from", "a.urdf"]
    assert "not allowed with" in complaint(main, both, capsys)
    assert "is not valid; give letters" in complaint(main, ["new", "a/b", "--template", "skid4"], capsys)
