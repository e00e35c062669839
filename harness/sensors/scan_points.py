"""Where the beams of a scan hit something, seen from above."""

from functools import cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.samples import PlacedScan
from harness.sensors.lidar_spec import LidarSpec
from harness.world.obstacles import rotation_matrix

Points = NDArray[np.float64]  # shape (k, 2): x, y in the world [m]


def scan_points(placed: PlacedScan, rover: RoverSpec) -> Points:
    """Returns where the beams of a scan hit something, shape (k, 2) in the world [m]."""
    ranges = placed.scan.ranges.astype(np.float64)
    hit = np.isfinite(ranges)
    angles = LidarSpec(beams=len(ranges)).angles[hit]
    beams = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    mount, axes = _lidar_mount(rover)
    in_rover = mount + (ranges[hit, None] * beams) @ axes.T
    x, y, z, w = placed.pose.orientation
    in_world = in_rover @ rotation_matrix((w, x, y, z)).T + placed.pose.position
    return np.asarray(in_world[:, :2])


@cache
def _lidar_mount(rover: RoverSpec) -> tuple[Points, Points]:
    """Returns position [m] and rotation of the lidar in the model frame, from the rover's model file."""
    model = mujoco.MjModel.from_xml_path(str(rover.model_path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    body, site = data.body("rover"), data.site("lidar")
    to_rover = body.xmat.reshape(3, 3).T
    return to_rover @ (site.xpos - body.xpos), to_rover @ site.xmat.reshape(3, 3)
