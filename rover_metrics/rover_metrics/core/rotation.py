"""Angles and axes of an attitude: the unit quaternion (x, y, z, w) that turns a frame into the world.

The order of every operation is part of the logs' bytes.
"""

import math

Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]  # x, y, z, w


def matrix(attitude: Quaternion) -> tuple[Vector3, Vector3, Vector3]:
    """Returns the rows of R_world_frame; the last one is the world's vertical in the frame's axes."""
    x, y, z, w = attitude
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def upright(attitude: Quaternion) -> float:
    """Returns the cosine of the angle between the vertical axes of frame and world: 1 stands upright."""
    x, y, _, _ = attitude
    return 1.0 - 2.0 * (x * x + y * y)


def tilt(attitude: Quaternion) -> float:
    """Returns the angle between the vertical axes of frame and world [rad]."""
    return math.acos(max(-1.0, min(1.0, upright(attitude))))


def yaw(attitude: Quaternion) -> float:
    """Returns the heading of the frame's x axis in the world [rad]."""
    x, y, z, w = attitude
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def roll_pitch(attitude: Quaternion) -> tuple[float, float]:
    """Returns roll and pitch [rad] as REP-103 has them: yaw about z, pitch about y, roll about x."""
    x, y, z, w = attitude
    roll = math.atan2(2.0 * (w * x + y * z), upright(attitude))
    return roll, math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
