"""Poses against the truth: evo, closed forms, and a run through ROS whose truth is published."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.scenario import trajectory
from harness.scenario.case import plan
from harness.scenario.names import POSE, heard_quantity
from harness.scenario.poses import Row, TruePath, chained, pose_series, rows_of

Poses = trajectory.Poses


def walk(seed: int, count: int = 400) -> tuple[Poses, Poses, Poses]:
    """Times, a smooth true path, and an estimate that drifts and is turned."""
    rng, times = np.random.default_rng(seed), np.linspace(0.0, 0.05 * (count - 1), count)
    yaw: Poses = np.cumsum(rng.normal(0.0, 0.03, count))
    steps = 0.03 * np.column_stack([np.cos(yaw), np.sin(yaw)])
    truth = np.column_stack([np.cumsum(steps, axis=0), yaw])
    drift = np.cumsum(rng.normal(0.0, 0.002, (count, 3)), axis=0)
    return times, truth, truth + drift + (0.3, -0.2, 0.1)


def evo_rmse(metric: Any, estimate: Poses, truth: Poses, *, align: bool = False) -> float:  # noqa: ANN401 - evo's
    """What evo makes of poses in the plane, as evo_ape and evo_rpe do."""
    kind = pytest.importorskip("evo.core.trajectory", reason="evo is not installed").PosePath3D

    def path(poses: Poses) -> Any:  # noqa: ANN401
        quaternions = np.roll(Rotation.from_euler("z", poses[:, 2:]).as_quat(), 1, axis=1)
        places = np.column_stack([poses[:, :2], np.zeros(len(poses))])
        return kind(positions_xyz=places, orientations_quat_wxyz=quaternions)

    reference, own = path(truth), path(estimate)
    if align:
        own.align(reference)
    metric.process_data((reference, own))
    return float(metric.get_all_statistics()["rmse"])


@pytest.mark.parametrize("seed", range(2))
def test_errors_are_those_of_evo(seed: int) -> None:
    evo: Any = pytest.importorskip("evo.core.metrics", reason="evo is not installed")
    relation, (_, truth, estimate) = evo.PoseRelation, walk(seed)
    moved = trajectory.aligned(estimate, truth)
    drift = evo.RPE(relation.translation_part, 1, evo.Unit.meters, pairs_from_reference=True)
    places, angles = (evo.APE(one) for one in (relation.translation_part, relation.rotation_angle_rad))
    for ours, metric, align in (
        (trajectory.ate(estimate, truth), places, False),
        (trajectory.ate(moved, truth), places, True),
        (trajectory.rpe(estimate, truth), drift, False),
        (trajectory.yaw_error(estimate, truth), angles, False),
        (trajectory.yaw_error(moved, truth), angles, True),
    ):
        assert ours == pytest.approx(evo_rmse(metric, estimate, truth, align=align), abs=1e-6)


def test_a_filter_that_knows_its_errors_has_a_nees_of_three() -> None:
    rng, truth = np.random.default_rng(1), np.zeros((20_000, 3))
    square = np.diag([0.04, 0.01, 0.0025])
    estimate = truth + rng.multivariate_normal(np.zeros(3), square, len(truth))
    said = np.broadcast_to(square, (len(truth), 3, 3))
    assert trajectory.nees(estimate, truth, said) == pytest.approx(3.0, rel=0.03)
    assert trajectory.nees(estimate, truth, said / 4.0) == pytest.approx(12.0, rel=0.03)
    assert np.isnan(trajectory.nees(estimate, truth, 0.0 * said))


@pytest.mark.parametrize("seed", range(3))
def test_alignment_undoes_any_move_and_truth_is_interpolated_at_stamps(seed: int) -> None:
    times, truth, _ = walk(seed)
    away = np.column_stack(
        [trajectory.turned(truth[:, :2], 2.0) + np.array([5.0, -3.0]), truth[:, 2] + 2.0]
    )
    assert trajectory.ate(trajectory.aligned(away, truth), truth) < 1e-9
    between = trajectory.at_times(times, truth, times[:-1] + 0.025)
    assert between == pytest.approx(0.5 * (truth[1:] + truth[:-1]))
    assert np.isnan(trajectory.at_times(times, truth, np.array([-1.0]))).all()
    (west,) = trajectory.at_times(times[:2], np.array([(0, 0, 3.1), (0, 0, -3.1)]), times[:1] + 0.01)
    assert np.cos(west[2]) < -0.99


def test_a_frame_is_chained_through_what_was_told_last() -> None:
    def row(stamp: int, parent: str, child: str, x: float, turn: float = 0.0) -> Row:
        pose = np.eye(4)
        pose[:3, :3], pose[0, 3] = Rotation.from_euler("z", turn).as_matrix(), x
        return Row(stamp, parent, child, pose)

    fixed = [row(0, "base_footprint", "base_link", 0.5)]
    moving = [row(1, "odom", "base_footprint", 1.0), row(2, "map", "odom", 10.0, np.pi / 2)]
    moving += [row(3, "odom", "base_footprint", 2.0), row(4, "map", "odom", 20.0)]
    found = list(chained(fixed, moving, "map", "base_link"))
    (one,) = found
    assert (one.stamp_ns, *one.pose[:2, 3]) == pytest.approx(
        (3, 10.0, 2.5)
    )  # the map is turned to the left


def test_a_nees_is_of_the_variances_in_the_plane() -> None:
    variances = np.diag([0.04, 0.01, 9.0, 9.0, 9.0, 0.0025])  # x, y, z, roll, pitch, yaw
    x, y, z, w = Rotation.from_euler("z", 0.1).as_quat()
    turn, place = SimpleNamespace(x=x, y=y, z=z, w=w), SimpleNamespace(x=0.4, y=0.0, z=0.0)
    pose = SimpleNamespace(position=place, orientation=turn)
    header = SimpleNamespace(stamp=SimpleNamespace(sec=1, nanosec=0), frame_id="map")
    spread = SimpleNamespace(pose=pose, covariance=variances.ravel())
    rows = [*rows_of(SimpleNamespace(header=header, pose=spread))]
    asked = heard_quantity("pose./slam/pose.nees", POSE)
    assert asked is not None
    found = pose_series(asked, {"/slam/pose": rows}, TruePath([0.5, 1.5], [(0.0, 0.0, 0.0)] * 2))
    assert found.values == pytest.approx([0.4**2 / 0.04 + 0.1**2 / 0.0025])


def test_what_cannot_be_measured_says_why() -> None:
    stamp = SimpleNamespace(sec=1, nanosec=0)
    place = SimpleNamespace(x=float("nan"), y=0.0, z=0.0)
    turn = SimpleNamespace(x=0.0, y=0.0, z=0.0, w=1.0)
    pose = SimpleNamespace(position=place, orientation=turn)
    message = SimpleNamespace(header=SimpleNamespace(stamp=stamp, frame_id="map"), pose=pose)
    truth = TruePath([0.5, 1.5], [(0.0, 0.0, 0.0)] * 2)
    asked = heard_quantity("pose./slam/pose.ate", POSE)
    assert asked is not None
    assert "1 of 1 poses" in pose_series(asked, {"/slam/pose": [*rows_of(message)]}, truth).nothing
    assert "no pose" in pose_series(asked, {}, truth).nothing
    place.x = 0.0
    for name, words in (("nees", "no covariance"), ("rpe_1m", "shorter")):
        asked = heard_quantity(f"pose./slam/pose.{name}", POSE)
        assert asked is not None
        assert words in pose_series(asked, {"/slam/pose": [*rows_of(message)]}, truth).nothing


SCENARIO = """
about: Published truth has no error, odometry has some.
terrain: rocky
driver: figure8
duration: 6
expect:
  pose./odom_ground_truth.ate: {max: 1.0e-9}
  pose.odom->base_footprint.ate: {max: 1.0e-4}  # between two samples of the truth
  pose.odom->base_footprint.yaw: {max: 1.0e-4}
  pose./odometry/wheels.ate: {min: 1.0e-4, max: 2.0}
  pose./odometry/wheels.rpe_1m: {min: 1.0e-4, max: 0.5}
"""


def test_poses_of_topics_and_frames_are_judged_through_ros(tmp_path: Path, ros_domain: int) -> None:
    pytest.importorskip("rclpy", reason="ROS 2 is not installed")
    from harness.scenario.attempt import attempt  # noqa: PLC0415

    del ros_domain
    (tmp_path / "p.scenario.yaml").write_text(SCENARIO)
    (case,) = plan([tmp_path / "p.scenario.yaml"])
    found = attempt(case, tmp_path / "out")
    assert (found.error, found.breaches) == (None, ())


@pytest.mark.parametrize("name", ["pose./odom.speed", "pose.odom.ate", "pose./a->b.ate"])
def test_a_wrong_name_is_refused_with_the_right_ones(name: str, tmp_path: Path) -> None:
    (tmp_path / "p.scenario.yaml").write_text(SCENARIO.replace("pose./odom_ground_truth.ate", name))
    with pytest.raises(UsageError, match="rpe_1m"):
        plan([tmp_path / "p.scenario.yaml"])
