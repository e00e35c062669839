import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.gym.observation import (
    AHEAD,
    LEFT,
    Limits,
    height_part,
    heights_around,
    point_nav_parts,
    space_of,
)
from harness.samples import Pose
from harness.world.heightfield import Heightfield


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_heights_are_those_of_a_plane_around_the_rover(yaw: float) -> None:
    x, y = np.meshgrid(np.linspace(-5.0, 5.0, 41), np.linspace(-5.0, 5.0, 41))
    plane = Heightfield(0.2 * x - 0.1 * y, 0.25)
    qx, qy, qz, qw = Rotation.from_euler("ZYX", [yaw, 0.2, 0.3]).as_quat().tolist()
    pose = Pose(0, (1.0, -1.0, 0.5), (qx, qy, qz, qw))  # roll and pitch do not turn it
    seen = np.array(heights_around(plane, pose)).reshape(len(AHEAD), len(LEFT))
    here, along, aside = 0.3 - 0.5, 0.2 * math.cos(yaw) - 0.1 * math.sin(yaw), -0.2 * math.sin(yaw)
    aside -= 0.1 * math.cos(yaw)
    assert seen == pytest.approx(here + along * np.array(AHEAD)[:, None] + aside * np.array(LEFT))
    assert (AHEAD[0], AHEAD[-1], LEFT[0], LEFT[-1]) == (-0.5, 1.5, 0.6, -0.6)
    assert "-0.5 to 1.5 m ahead, 0.6 m left to right" in height_part().about


def test_an_observation_is_kept_within_its_space() -> None:
    space: Any = space_of(point_nav_parts(3, 10.0))
    limits = Limits(space)
    for sign in (1.0, -1.0):
        values = {name: np.full(box.shape or (), sign * 1e9) for name, box in space.items()}
        seen = limits.keep(values)
        assert space.contains(seen)
        again = limits.keep(values)
        assert not any(np.shares_memory(seen[name], again[name]) for name in seen)
        ends = {name: getattr(box, "high" if sign > 0 else "low") for name, box in space.items()}
        assert all(seen[name].tolist() == end.tolist() for name, end in ends.items())
    within = {name: np.linspace(-0.5, 0.5, *box.shape).clip(box.low) for name, box in space.items()}
    kept = limits.keep(within)
    assert all(kept[name].tolist() == value.astype("f4").tolist() for name, value in within.items())
