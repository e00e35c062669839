"""The command: what it drives, what it says, how it ends."""

import pytest

from harness.robots import ROVERS, RoverSpec
from harness.robots.sections import Span
from harness.validate import __main__ as validate
from harness.validate.check import Check
from tests.support.complaint import complaint

GOOD = Check("speed", "m/s", Span(0.49, 0.50, "S: recorded"), 0.495)
BAD = Check("stopping distance", "m", Span(0.04, 0.05, "D: v^2 / 2a"), 0.4)


@pytest.mark.parametrize(
    ("words", "driven"),
    [("", [(name, 0) for name in ROVERS]), ("--robot leo --seed 7", [("leo", 7)])],
)
def test_all_rovers_are_driven_unless_one_is_chosen_and_a_miss_is_exit_code_1(
    words: str,
    driven: list[tuple[str, int]],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    calls: list[tuple[str, int]] = []
    checks = [GOOD]

    def fake(rover: RoverSpec, seed: int, show: object) -> list[Check]:  # noqa: ARG001 - of real ones
        calls.append((rover.name, seed))
        return checks

    monkeypatch.setattr("harness.validate.suite.validate", fake)
    assert validate.main(words.split()) == 0
    assert (calls, capsys.readouterr().err) == (driven, "")
    checks.append(BAD)
    assert validate.main(words.split()) == 1
    missed = "; ".join(f"{name}: stopping distance" for name, _ in driven)
    assert capsys.readouterr().err == f"harness.validate: missed {missed}\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("--robot spirit", "available: husky, jackal, leo, rover_zero4wd"),
        ("--seed -1", "whole number from 0 up"),
        ("--realism a.csv b.csv", "--realism needs --robot"),
        ("--robot leo --realism /none/a.csv /none/b.csv", "--realism takes two logs"),
        ("--seed many", "argument --seed: 'many' is not valid; give a whole number"),
    ],
)
def test_bad_arguments_are_one_line_and_exit_code_2(
    words: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert said in complaint(validate.main, words.split(), capsys)
