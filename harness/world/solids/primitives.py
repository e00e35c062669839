"""Boxes, cylinders and ellipsoids as obstacles, unless they lie in the ground."""

from dataclasses import replace

import numpy as np

from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, outline, top
from harness.world.solid import Primitive, Solid
from harness.world.solids.kinds import Kind
from harness.world.solids.pieces import FLUSH
from harness.world.solids.surface import on_map


def obstacle_of(solid: Solid, ground: Heightfield, kind: Kind) -> Obstacle | None:
    """Returns a primitive as an obstacle; None if it lies in the ground or off the map.

    Args:
        solid: Whose shape is a Primitive.
        ground: On which it stands.
        kind: What an obstacle is whose top is that high above the lowest ground below it [m].
    """
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 - 0.1 s that named terrains save

    assert isinstance(solid.shape, Primitive)  # noqa: S101 - the caller has looked
    x, y, z, w = Rotation.from_matrix(solid.pose[:3, :3]).as_quat(canonical=True).tolist()
    position = tuple(solid.pose[:3, 3].tolist())
    obstacle = Obstacle(
        ObstacleKind.HAZARD,
        solid.shape.shape,
        solid.shape.half_size,
        position,
        (w, x, y, z),
        color=solid.color,
    )
    below = np.vstack([outline(obstacle), position[:2]])
    below = below[on_map(below, ground)]
    if not len(below):
        return None
    height = top(obstacle) - float(ground.heights_at(*below.T).min())
    return replace(obstacle, kind=kind(height)) if height > FLUSH else None
