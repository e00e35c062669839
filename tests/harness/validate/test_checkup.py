"""What is odd about rovers is found, and nothing about one that is as it should be."""

import math
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from harness import robot as command
from harness.robots import ROVERS, RoverSpec, find_rover
from harness.validate import driving, square
from harness.validate.checkup import check_up, wheel_loads
from harness.validate.grounds import flat
from harness.validate.rig import Rig
from harness.validate.suite import cells_of
from tests.support.complaint import complaint
from tests.support.foreign_rovers import FOREIGN
from tests.support.snapshots import check_snapshot

Foreign = Callable[[str], RoverSpec]


@pytest.mark.parametrize("name", [*ROVERS, *FOREIGN])
def test_nothing_is_odd_about_a_rover_that_ships_or_has_public_numbers(
    name: str, foreign: Foreign
) -> None:
    rover = ROVERS[name] if name in ROVERS else foreign(name)
    checks = {check.quantity: check for check in check_up(rover)}
    assert [name for name, check in checks.items() if not check.passed] == []
    if name in ("a200", "buggy"):  # what is asked and why
        cells = (
            (
                *cells_of(check)[:2],
                f"{round(check.measured, check.digits) + 0.0:.2g}",
                str(check.digits),
                check.expected.source,
            )
            for check in checks.values()
        )
        asked = re.sub("load of the [a-z ]+ wheel", "load of a wheel", "\n".join(map(" | ".join, cells)))
        check_snapshot(f"check_{name}.txt", f"{asked}\n")
    if name == "buggy":
        assert checks["mass"].measured == pytest.approx(3.74)
        # All masses are as high as the axles; those of hinges and wheels are off the middle.
        ahead = (0.15875 * (2 * 0.05 + 2 * 0.2) - 0.17145 * 2 * 0.2) / 3.74
        backward = math.degrees(math.atan2(0.17145 + ahead, 0.0508))
        tip = checks["tip angle backward, by its centre of mass"]
        assert tip.measured == pytest.approx(backward, abs=1.5)


def test_a_rover_that_would_leave_the_plane_is_driven_more_slowly(tmp_path: Path) -> None:
    folder = Path(shutil.copytree(ROVERS["leo"].folder, tmp_path / "leo"))
    model = folder / "leo.xml"
    fast = model.read_text().replace("-12 12", "-240 240").replace("-4 4", "-40 40")
    model.write_text(fast)
    names = [check.quantity for check in check_up(find_rover(str(folder)))]
    assert "failures of the simulation" not in names
    assert sum("speed reached" in name for name in names) == 2


def test_a_rover_that_steers_is_driven_in_curves_and_passes(foreign: Foreign) -> None:
    rover = foreign("buggy")
    checks = {
        check.quantity: check
        for manoeuvres in (driving, square)
        for check in manoeuvres.checks(rover, 1)
    }
    assert [name for name, check in checks.items() if not check.passed] == []
    assert {name for name in checks if "curve" in name or "circle" in name} == {
        "yaw ratio in a curve, 0.3 m/s",
        "odometry in a circle, yaw told / true",
        "odometry in a circle, path told / true",
    }
    force, rate = driving.at_rest(Rig(rover, flat()), 20, 0.5)
    assert (len(force), len(rate)) == (10, 10)


@pytest.mark.parametrize("name", ROVERS)
def test_the_wheels_carry_the_whole_weight(name: str) -> None:
    shares = wheel_loads(Rig(ROVERS[name], flat()))
    assert sum(shares) == pytest.approx(1.0, abs=0.01)
    assert min(shares) > 0.1


def test_the_command_names_what_is_wrong_with_a_model(
    foreign: Foreign, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A chassis of 5 t that looks 1 km long, a rear wheel in the air."""
    folder = Path(shutil.copytree(foreign("a200").folder, tmp_path / "a200"))
    model = folder / "a200.xml"
    text = model.read_text().replace('mass="46.034"', 'mass="5046"')
    in_the_air = '<body name="rear_right_wheel" pos="-0.256 -0.2854 0.'
    text = text.replace(f'{in_the_air}0328"', f'{in_the_air}0928"')
    shape = 'pos="0 0 0.1824" type="box" contype="0"'
    text = text.replace(f'0.4937 0.28545 0.12375" {shape}', f'493.7 285.45 123.75" {shape}')
    assert text.count("5046") == text.count("493.7") == text.count("0.0928") == 1
    model.write_text(text)
    assert command.main(["check", str(folder)]) == 1
    told = capsys.readouterr()
    odd = [line.removeprefix("harness.robot: odd: ") for line in told.err.splitlines()]
    for quantity in (
        "mass: ",
        "size of what is seen",
        "radius of gyration of 'base_link'",
        "load of the ",
    ):
        assert any(line.startswith(quantity) for line in odd), quantity
    assert "creep" in told.out  # what is not odd is shown too


def test_the_command_takes_shipped_rovers_and_refuses_names_that_nobody_has(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("harness.validate.checkup.check_up", lambda _: [])
    assert command.main(["check", "leo"]) == 0
    capsys.readouterr()
    assert "robot 'spirit' does not exist" in complaint(command.main, ["check", "spirit"], capsys)
