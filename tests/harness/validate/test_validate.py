"""The command: what it drives, what it says, how it ends."""

import pytest

from harness.robots import RoverSpec
from harness.robots.sections import Span
from harness.validate import __main__ as validate
from harness.validate.check import Check
from tests.support.complaint import complaint

GOOD = Check("speed", "m/s", Span(0.49, 0.50, "S: recorded"), 0.495)
BAD = Check("stopping distance", "m", Span(0.04, 0.05, "D: v^2 / 2a"), 0.4)


def drives(monkeypatch: pytest.MonkeyPatch, *checks: Check) -> list[tuple[str, int]]:
    """Replaces the suite; the list tells which rover was driven with which seed."""
    calls: list[tuple[str, int]] = []

    def fake(rover: RoverSpec, seed: int) -> list[Check]:
        calls.append((rover.name, seed))
        return list(checks)

    monkeypatch.setattr(validate, "validate", fake)
    return calls


@pytest.mark.parametrize(
    ("words", "driven"),
    [("", [("leo", 0), ("rover_zero4wd", 0)]), ("--robot leo --seed 7", [("leo", 7)])],
)
def test_all_rovers_are_driven_unless_one_is_chosen_and_a_pass_is_exit_code_0(
    words: str, driven: list[tuple[str, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = drives(monkeypatch, GOOD)
    assert validate.main(words.split()) == 0
    assert calls == driven


def test_a_miss_is_named_and_is_exit_code_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    drives(monkeypatch, GOOD, BAD)
    assert validate.main(["--robot", "leo"]) == 1
    assert capsys.readouterr().err == "harness.validate: missed leo: stopping distance\n"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--robot", "spirit"], "available: leo, rover_zero4wd"),
        (["--seed", "-1"], "whole number from 0 up"),
        (["--realism", "a.csv", "b.csv"], "--realism needs --robot"),
        (
            ["--robot", "leo", "--realism", "/none/a.csv", "/none/b.csv"],
            "--realism takes two logs",
        ),
        (["--seed", "many"], "argument --seed: 'many' is not valid; give a whole number"),
    ],
)
def test_bad_arguments_are_one_line_and_exit_code_2(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert said in complaint(validate.main, arguments, capsys)
