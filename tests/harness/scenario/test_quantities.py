"""Quantities by name."""

import pytest

from harness.scenario.quantities import check_name, names


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("truth.speed", None),
        ("log.Obstacle Clearance", None),
        ("log.Scan Rate [Hz]", None),
        ("truth.sped", "quantity 'truth.sped' does not exist; did you mean 'truth.speed'?"),
        ("log.Timestamp", "quantity 'log.Timestamp' does not exist"),
        ("log.Notes", "quantity 'log.Notes' does not exist"),
        ("x", f"quantity 'x' does not exist; available: {', '.join(names())}"),
    ],
)
def test_a_name_that_does_not_exist_is_told_with_the_nearest(name: str, told: str | None) -> None:
    problem = check_name(name)
    assert problem is None if told is None else str(problem).startswith(told)
