"""Silhouettes against points sampled all over the bodies."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.world.obstacles import Obstacle, ObstacleKind, Shape, half_extent, outline, rotation_matrix

Points = NDArray[np.float64]

HALF: dict[Shape, tuple[float, ...]] = {
    "box": (0.5, 0.2, 0.8),
    "ellipsoid": (0.5, 0.2, 0.8),
    "cylinder": (0.3, 0.7),
}


def surface(shape: Shape, half: tuple[float, ...]) -> Points:
    """Points of a body in its own frame [m]: corners, or a fine net."""
    if shape == "box":
        corners = np.stack(np.meshgrid(*[(-1, 1)] * 3), -1).reshape(-1, 3)
        return np.asarray(corners * half)
    turn, tilt = np.meshgrid(np.linspace(0, math.tau, 721), np.linspace(0, math.pi, 361))
    if shape == "cylinder":
        edge = turn[0]
        ring = np.column_stack([half[0] * np.cos(edge), half[0] * np.sin(edge)])
        return np.concatenate(
            [np.column_stack([ring, np.full(len(edge), z)]) for z in (-half[1], half[1])]
        )
    ball = np.stack([np.cos(turn) * np.sin(tilt), np.sin(turn) * np.sin(tilt), np.cos(tilt)], -1)
    return np.asarray(ball.reshape(-1, 3) * half)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("shape", HALF)
def test_a_silhouette_reaches_as_far_as_the_body_in_every_direction(shape: Shape, seed: int) -> None:
    turn = Rotation.random(rng=np.random.default_rng(seed))
    w, x, y, z = turn.as_quat(scalar_first=True).tolist()
    body = Obstacle(
        kind=ObstacleKind.ROCK,
        shape=shape,
        half_size=HALF[shape],
        position=(3.0, -2.0, 1.0),
        quaternion=(w, x, y, z),
    )
    seen = turn.apply(surface(shape, HALF[shape]))[:, :2]
    angles = np.arange(24) * math.tau / 24
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    reach = (seen @ directions.T).max(axis=0)

    corners = outline(body) - (3.0, -2.0)

    assert rotation_matrix(body.quaternion) == pytest.approx(turn.as_matrix())
    assert [half_extent(body, angle) for angle in angles] == pytest.approx(reach.tolist(), abs=1e-4)
    assert (corners * directions).sum(axis=1) == pytest.approx(reach, abs=1e-4)
    assert (corners @ directions.T <= reach + 1e-4).all()
