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
        ({"bodies": ((0.1, 0.0, 0.3),)}, (2.0 - 7.0 * math.exp(0.25 / 0.3), 0.0)),  # not ever more
        ({"walls": (WALL,)}, (2.0, -50.0 * math.exp(-0.75 / 0.2))),
        ({"walls": (WALL + np.array([0.0, 1.2]),)}, (2.0, -50.0 * math.exp(-1.95 / 0.2))),
        ({"walls": (WALL + np.array([0.0, 1.3]),)}, (2.0, 0.0)),
        ({"walls": (WALL - np.array([0.0, 0.8]),)}, (2.0, 0.0)),  # who is in one is pushed by none
    ],
)
def test_forces_are_those_of_the_paper(given: dict[str, object], expected: tuple[float, float]) -> None:
    assert force(**given) == pytest.approx(expected, rel=1e-6)  # type: ignore[arg-type]


def pushed(degrees: float, wanted: np.ndarray) -> float:
    """How strongly one is pushed by a body a metre away, seen from the x axis."""
    body = (math.cos(math.radians(degrees)), math.sin(math.radians(degrees)), 0.3)
    _, alone = step(STILL, STILL, wanted, radius=0.25, bodies=(), walls=(), seconds=1e-6)
    _, after = step(STILL, STILL, wanted, radius=0.25, bodies=(body,), walls=(), seconds=1e-6)
    return math.dist(after, alone) / 1e-6 / (7.0 * math.exp(-0.45 / 0.3))


def test_what_is_more_than_100_degrees_aside_counts_half() -> None:
    for speed in (1.0, 0.2, 3.0):
        found = [pushed(degrees, speed * WANTED) for degrees in (0, 99, -99, 101, -101, 180)]
        assert found == pytest.approx([1.0, 1.0, 1.0, 0.5, 0.5, 0.5], rel=1e-6)


def test_nobody_is_faster_than_in_a_hurry_and_a_step_is_the_speed() -> None:
    fast = np.array([3.0, 4.0])
    for speed in (1.0, 0.5, 0.0):
        wanted = speed * WANTED
        place, velocity = step(STILL, fast, wanted, radius=0.25, bodies=(), walls=(), seconds=0.01)
        assert math.hypot(*velocity) == pytest.approx(1.3 * speed)
        free = fast + 0.01 * (wanted - fast) / 0.5
        np.testing.assert_allclose(velocity, free * (1.3 * speed / np.linalg.norm(free)))
        np.testing.assert_allclose(place, 0.01 * velocity)
