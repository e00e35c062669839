"""Who goes to goals does not know left from right: in the mirror of a place it drives the mirror."""

from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.drivers import find_driver
from harness.drivers.base import TakesGoals
from tests.harness.drivers.jackal import Pose, Turned, context, drives, lidar

POSTS = np.array([(1.6, 0.3), (2.4, -0.9), (3.2, 1.3), (1.2, 1.4), (3.6, 0.2), (0.9, -1.1), (-1.0, 0.6)])
RADIUS = 0.2  # [m]
AHEAD, BEHIND = (4.0, 1.5), (-2.0, 0.8)


def ranges(pose: Pose, side: float) -> NDArray[np.float32]:
    """What a lidar sees of posts, or of their mirrors."""
    x, y, angles = lidar(pose)
    off = POSTS * (1.0, side) - (x, y)
    along = np.cos(angles)[:, None] * off[:, 0] + np.sin(angles)[:, None] * off[:, 1]
    beside = RADIUS**2 - ((off**2).sum(axis=1) - along**2)
    hit = np.where((along > 0.0) & (beside > 0.0), along - np.sqrt(np.maximum(beside, 0.0)), np.inf)
    return np.asarray(hit.min(axis=1), np.float32)


@pytest.mark.parametrize("goal", [AHEAD, BEHIND])
@pytest.mark.parametrize("name", ["goal", "beeline", "gap", "dwa"])
def test_a_mirrored_place_is_driven_through_in_the_mirror(name: str, goal: tuple[float, float]) -> None:
    if (name, goal) == ("goal", BEHIND):
        return  # its directions are 7.5 deg apart: of two as good ones either may be taken
    x, y = goal
    paths = []
    for side in (1.0, -1.0):
        driver = find_driver(name)(context())
        assert isinstance(driver, TakesGoals)
        driver.head_for(x, side * y, 0.0)
        paths.append(np.array([pose for pose, _ in drives(driver, partial(ranges, side=side), 40)]))
    one, other = paths
    assert np.ptp(one[:, 1]) > 0.1
    assert other * [1.0, -1.0, -1.0] == pytest.approx(one, abs=0.15)
    turned = Turned(find_driver(name)(context()))
    turned.head_for(x, y, 0.0)
    again = [pose for pose, _ in drives(turned, partial(ranges, side=1.0), 40)]
    assert np.array(again) == pytest.approx(one, abs=0.15)
