"""Helbing and Molnar's forces, written out."""

import math

import numpy as np
import pytest

from harness.world.actors.social_force import step

STILL, WANTED = np.zeros(2), np.array([1.0, 0.0])
WALL = np.array([[-1.0, 1.0], [1.0, 1.0], [1.0, 2.0], [-1.0, 2.0]])


def force(
    *,
    velocity: np.ndarray = STILL,
    bodies: tuple[tuple[float, float, float], ...] = (),
    walls: tuple[np.ndarray, ...] = (),
) -> list[float]:
    seconds = 1e-6  # so short that nobody is too fast
    _, after = step(STILL, velocity, WANTED, radius=0.25, bodies=bodies, walls=walls, seconds=seconds)
    x, y = ((after - velocity) / seconds).tolist()
    return [x, y]


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, (2.0, 0.0)),
        ({"velocity": np.array([0.5, 0.2])}, (1.0, -0.4)),
        ({"bodies": ((1.0, 0.0, 0.3),)}, (2.0 - 7.0 * math.exp(-0.45 / 0.3), 0.0)),
        ({"bodies": ((-1.0, 0.0, 0.3),)}, (2.0 + 0.5 * 7.0 * math.exp(-0.45 / 0.3), 0.0)),
        ({"bodies": ((0.0, 1.0, 0.3), (9.0, 0.0, 0.3), (0.0, 0.0, 0.3))}, (2.0, -7.0 * math.exp(-1.5))),
        ({"bodies": ((2.5, 0.0, 0.3),)}, (2.0 - 7.0 * math.exp(-1.95 / 0.3), 0.0)),
        ({"bodies": ((2.6, 0.0, 0.3),)}, (2.0, 0.0)),  # out of sight
        ({"walls": (WALL,)}, (2.0, -50.0 * math.exp(-0.75 / 0.2))),
        ({"walls": (WALL + np.array([0.0, 9.0]),)}, (2.0, 0.0)),
    ],
)
def test_forces_are_those_of_the_paper(given: dict[str, object], expected: tuple[float, float]) -> None:
    assert force(**given) == pytest.approx(expected, rel=1e-6)  # type: ignore[arg-type]


def test_nobody_is_faster_than_in_a_hurry_and_a_step_is_the_speed() -> None:
    fast = np.array([3.0, 4.0])
    place, velocity = step(STILL, fast, WANTED, radius=0.25, bodies=(), walls=(), seconds=0.01)
    assert math.hypot(*velocity) == pytest.approx(1.3)
    np.testing.assert_allclose(place, 0.01 * velocity)
