"""Clouds and depth images of a run, point by point, against MuJoCo's rays from the mount."""

from typing import Any

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.episode.episode import Episode
from harness.robots import find_rover
from harness.ros.messages import filler
from harness.sensors.choice import chosen
from harness.sensors.lidar_spec import LidarSpec
from harness.sensors.ranging import RangeReading
from harness.spec.run import Run

XYZ, RPY = (0.1, -0.2, 0.7), (0.2, 0.3, -0.4)
MOUNT = {"parent": "base_footprint", "xyz": list(XYZ), "rpy": list(RPY)}
FARTHEST = 6.0
LEO = find_rover("leo").but(
    sensors=(
        {"kind": "lidar3d", "rings": 6, "columns": 12, "organised": True, "range_max": FARTHEST} | MOUNT,
        {"kind": "depth", "width": 8, "height": 6, "cloud": True, "range_max": FARTHEST} | MOUNT,
    ),
)


def test_points_and_depths_are_where_mujocos_rays_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("harness.episode.assembly.chosen", lambda _, asked: chosen(LEO, asked))
    episode = Episode(Run.of(terrain="rocky", driver="spin", lidar_beams=8, duration=0.1))
    (*_, last) = (tick for batch in episode.batches() for tick in batch.ticks)
    readings = {s.sensor: s for s in last.samples if isinstance(s, RangeReading)}
    model, data = episode.simulation.model, episode.simulation.data
    mujoco.mj_kinematics(model, data)
    base = Rotation.from_quat(data.qpos[[4, 5, 6, 3]])
    origin, turn = data.qpos[:3] + base.apply(XYZ), base * Rotation.from_euler("xyz", RPY)
    optical = turn * Rotation.from_matrix([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])

    def ray(direction: np.ndarray) -> float:
        """Distance along a unit vector of the world [m]."""
        seen, hit = np.array([1, 1, 0, 0, 0, 0], np.uint8), np.zeros(1, np.int32)
        found = mujoco.mj_ray(model, data, origin, direction, seen, 1, -1, hit)
        return found if found >= 0.0 else np.inf

    hits = 0
    messages: dict[tuple[str, str], Any] = {}
    for row in chosen(LEO, None):
        for topic in row.topics if row.given is not None else ():
            fill = filler(row, topic, LEO, LidarSpec())
            messages[row.given.name, topic.name] = fill(readings[row.given.name])  # type: ignore[union-attr]
    for name, frame in (("lidar3d", turn), ("depth", optical)):
        cloud = messages[name, f"{name}/points"]
        floats = np.frombuffer(cloud.data, np.uint8).reshape(-1, cloud.point_step)[:, :12]
        points = np.ascontiguousarray(floats).view("<f4").astype(float)
        for point in points[np.isfinite(points).all(axis=1)]:
            distance = float(np.linalg.norm(point))
            assert ray(frame.apply(point / distance)) == pytest.approx(distance, abs=1e-5)
            hits += 1
    assert hits > 50
    image = np.frombuffer(messages["depth", "depth/image"].data, "<f4").reshape(6, 8)
    info = messages["depth", "depth/camera_info"]
    for v, u in np.ndindex(image.shape):  # by the message's own calibration
        pixel = np.array([(u - info.k[2]) / info.k[0], (v - info.k[5]) / info.k[4], 1.0])
        depth = ray(optical.apply(pixel / np.linalg.norm(pixel))) / np.linalg.norm(pixel)
        assert image[v, u] == pytest.approx(depth if depth <= FARTHEST else np.inf, abs=1e-5)
