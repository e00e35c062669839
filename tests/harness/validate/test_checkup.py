"""What is odd about rovers is found, and nothing about one that is as it should be."""

import math
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from harness import robot as command
from harness.robots import RoverSpec, read_rover
from harness.validate import checkup
from harness.validate.check import Check, Span
from tests.support.complaint import complaint

Foreign = Callable[[str], RoverSpec]


def by_name(checks: list[Check]) -> dict[str, Check]:
    return {check.quantity: check for check in checks}


def test_nothing_is_odd_about_a_buggy_made_of_public_numbers(foreign: Foreign) -> None:
    checks = by_name(checkup.check_up(foreign("buggy")))
    assert [name for name, check in checks.items() if not check.passed] == []
    assert checks["mass"].measured == pytest.approx(3.74)
    # All masses are as high as the axles; those of hinges and wheels are off the middle.
    ahead = (0.15875 * (2 * 0.05 + 2 * 0.2) - 0.17145 * 2 * 0.2) / 3.74
    backward = math.degrees(math.atan2(0.17145 + ahead, 0.0508))
    assert checks["tip angle backward, by its centre of mass"].measured == pytest.approx(
        backward, abs=1.5
    )


def test_what_is_wrong_with_a_model_is_named(foreign: Foreign, tmp_path: Path) -> None:
    """A chassis of 5 t, a rear wheel in the air."""
    folder = Path(shutil.copytree(foreign("husky").folder, tmp_path / "husky"))
    model = folder / "husky.xml"
    text = model.read_text().replace('mass="46.034"', 'mass="5046"')
    text = text.replace(
        '<body name="rear_right_wheel" pos="-0.256 -0.2854 0.0328"',
        '<body name="rear_right_wheel" pos="-0.256 -0.2854 0.0928"',
    )
    assert text != model.read_text()
    model.write_text(text)
    rover = read_rover(folder)
    found = [check for part in (checkup._masses, checkup._standing) for check in part(rover)]
    odd = {check.quantity for check in found if not check.passed}
    assert {"mass", "radius of gyration of 'base_link' / half its diagonal"} <= odd
    assert any(name.startswith("load of the ") for name in odd)


def test_the_command_prints_all_and_names_what_is_odd(
    foreign: Foreign, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    odd = Check("mass", "kg", Span(1.0, 2.0, "a source"), 3.0)
    fine = Check("creep", "mm/s", Span(0.0, 1.0, "another"), 0.5)
    monkeypatch.setattr(command, "check_up", lambda _: [odd, fine])
    assert command.main(["check", str(foreign("buggy").folder)]) == 1
    told = capsys.readouterr()
    assert "creep" in told.out
    assert told.err == "harness.robot: odd: mass: a source\n"
    monkeypatch.setattr(command, "check_up", lambda _: [fine])
    assert command.main(["check", "leo"]) == 0
    capsys.readouterr()
    assert "robot 'spirit' does not exist" in complaint(command.main, ["check", "spirit"], capsys)
