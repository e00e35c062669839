"""Lidar odometry of others eats our clouds and IMU, and finds where the rover went."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.clients.conftest import Run, recorded

Pose = NDArray[np.float64]  # shape (4, 4)
DURATION = 12.0  # [s]
VOXEL = 0.3  # [m]: the rovers' maze is 20 m wide
REACH = 30.0  # [m]


def pose_of(position: Any, orientation: Any) -> Pose:  # noqa: ANN401 - of messages
    pose = np.eye(4)
    turn = [orientation.x, orientation.y, orientation.z, orientation.w]
    pose[:3, :3] = Rotation.from_quat(turn).as_matrix()
    pose[:3, 3] = position.x, position.y, position.z
    return pose


def points_of(cloud: Any) -> NDArray[np.float64]:  # noqa: ANN401 - a message
    """Those that hit something, shape (n, 3)."""
    offsets = {field.name: field.offset for field in cloud.fields}
    rows = np.frombuffer(cloud.data, np.uint8).reshape(-1, cloud.point_step)
    columns = [rows[:, offsets[n] : offsets[n] + 4].copy().view(np.float32)[:, 0] for n in "xyz"]
    points = np.stack(columns, axis=1).astype(float)
    hits: NDArray[np.float64] = points[np.isfinite(points).all(axis=1)]
    return hits


def kiss_icp(messages: Iterator[tuple[str, int, Any]]) -> list[tuple[int, Pose]]:
    kiss = importlib.import_module("kiss_icp.kiss_icp")
    config = kiss.KISSConfig()
    config.data.max_range, config.data.deskew = REACH, False
    config.mapping.voxel_size, config.registration.max_num_threads = VOXEL, 1
    odometry, poses = kiss.KissICP(config), []
    for topic, stamp_ns, message in messages:
        if topic == "/lidar3d/points":
            points = points_of(message)
            odometry.register_frame(points, np.zeros(len(points)))
            poses.append((stamp_ns, odometry.last_pose.copy()))
    return poses


def rko_lio(messages: Iterator[tuple[str, int, Any]]) -> list[tuple[int, Pose]]:
    lio, config = (importlib.import_module(name) for name in ("rko_lio", "rko_lio.config"))
    config = config.LIOConfig()
    config.deskew, config.max_range, config.min_range = False, REACH, 0.5
    config.voxel_size, config.max_num_threads = VOXEL, 1
    odometry, poses = lio.LIO(config), []
    for topic, stamp_ns, message in messages:
        if topic == "/imu/data":
            force, rate = message.linear_acceleration, message.angular_velocity
            odometry.add_imu_measurement(
                np.array([force.x, force.y, force.z]), np.array([rate.x, rate.y, rate.z]), stamp_ns
            )
        elif topic == "/lidar3d/points":
            points = points_of(message)
            odometry.register_scan(points, np.full(len(points), stamp_ns, dtype=np.int64))
            poses.append((stamp_ns, odometry.pose().copy()))
    return poses


@pytest.mark.parametrize("robot", ["leo", "rover_zero4wd"])
def test_odometry_from_clouds_drifts_by_less_than_a_twentieth_of_the_way(
    run: Run, tmp_path: Path, robot: str
) -> None:
    for name in ("kiss_icp", "rko_lio"):  # before the drive
        pytest.importorskip(name, reason="needs kiss-icp and rko-lio: make test-clients")
    path = tmp_path / "run.mcap"
    words = f"--robot {robot} --terrain maze --driver wander --sensors lidar3d=vlp16 --imu-rate 100"
    run("--direct", *words.split(), "--duration", str(DURATION), "--record", str(path))
    messages = recorded(path, "/tf_static", "/imu/data", "/odom_ground_truth", "/lidar3d/points")
    fixed = [each for topic, _, m in messages if topic == "/tf_static" for each in m.transforms]
    mounts = {each.child_frame_id: each for each in fixed}
    mount = mounts[next(m.header.frame_id for topic, _, m in messages if topic == "/lidar3d/points")]
    lidar_in_base = pose_of(mount.transform.translation, mount.transform.rotation)
    truth = {
        stamp_ns: pose_of(m.pose.pose.position, m.pose.pose.orientation)
        for topic, stamp_ns, m in messages
        if topic == "/odom_ground_truth"
    }
    for odometry in (kiss_icp, rko_lio):
        found = [(s, pose) for s, pose in odometry(iter(messages)) if s in truth]
        expected = [truth[stamp_ns] @ lidar_in_base for stamp_ns, _ in found]
        way = np.linalg.norm(np.diff([p[:3, 3] for p in expected], axis=0), axis=1).sum()
        end = (np.linalg.inv(expected[0]) @ expected[-1])[:3, 3]
        drift = np.linalg.norm((np.linalg.inv(found[0][1]) @ found[-1][1])[:3, 3] - end)
        print(f"{robot}: {odometry.__name__} is off by {drift:.3f} m after {way:.2f} m")
        assert len(found) > DURATION
        assert drift < way / 20
