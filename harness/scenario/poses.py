"""Estimated poses that were heard, against the truth.

Truth is what /odom_ground_truth tells: the rover's planar pose in the world, which is odom and map.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import scipy  # loads a part of it when that is named

from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.samples import GroundTruth
from harness.scenario import trajectory
from harness.scenario.names import OF_POSES, TF, TF_STATIC, HeardQuantity
from harness.scenario.series import Series
from rover_metrics.topics import quaternion, stamp_ns, vector

TYPES = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "tf2_msgs/msg/TFMessage",
)
IN_PLANE = np.ix_([0, 1, 5], [0, 1, 5])  # x, y and yaw of a covariance of six


class Row(NamedTuple):
    """A pose that was heard: T_parent_child, and its covariance of six, if there is one."""

    stamp_ns: int
    parent: str
    child: str
    pose: Any
    covariance: Any = None


def rows_of(message: Any) -> Iterator[Row]:  # noqa: ANN401 - of rclpy or of rosbags
    """Yields the poses of a message of TYPES."""
    if hasattr(message, "transforms"):
        for each in message.transforms:
            moved, parent = each.transform, each.header.frame_id.lstrip("/")
            pose = _matrix(moved.translation, moved.rotation)
            yield Row(stamp_ns(each), parent, each.child_frame_id.lstrip("/"), pose)
        return
    inner = message.pose if hasattr(message.pose, "position") else message.pose.pose
    covariance = getattr(message.pose, "covariance", None)
    square = None if covariance is None else np.array(covariance, dtype=float).reshape(6, 6)
    yield Row(stamp_ns(message), "", "", _matrix(inner.position, inner.orientation), square)


def _matrix(position: Any, orientation: Any) -> np.ndarray:  # noqa: ANN401
    """T_parent_child; NaN where the attitude is none."""
    q = np.array(quaternion(orientation), dtype=float)
    pose = np.full((4, 4), np.nan)
    if np.isfinite(q).all() and q.any():
        pose[:3, :3] = scipy.spatial.transform.Rotation.from_quat(q).as_matrix()
    pose[:3, 3], pose[3] = vector(position), (0.0, 0.0, 0.0, 1.0)
    return pose


@dataclass
class TruePath:
    """An Observer: the true planar poses of a run."""

    times: list[float] = field(default_factory=list)
    poses: list[tuple[float, float, float]] = field(default_factory=list)

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        for tick in batch.ticks:
            if (sample := tick.of(GroundTruth)) is not None:
                self.times.append(sample.stamp_ns / NANOSECONDS)
                self.poses.append((sample.x, sample.y, sample.yaw))


def pose_series(quantity: HeardQuantity, heard: Mapping[str, Sequence[Row]], truth: TruePath) -> Series:
    """Returns what a quantity came to, in one value at the end; without any, and why.

    Args:
        quantity: Of a pose.
        heard: The rows of each topic, in the order of their arrival.
        truth: Of the run.
    """
    unit, _ = OF_POSES[quantity.measure]
    rows = [row for topic in quantity.topics for row in heard.get(topic, ())]
    if quantity.frames is not None:
        rows = list(chained(heard.get(TF_STATIC, ()), heard.get(TF, ()), *quantity.frames))
    of = " -> ".join(quantity.frames) if quantity.frames else quantity.topic
    value, nothing = float("nan"), f"no pose was heard of {of}"
    times, true = np.array(truth.times), np.array(truth.poses).reshape(-1, 3)
    stamps = np.array([row.stamp_ns for row in rows]) / NANOSECONDS
    if rows and len(times):
        beside = trajectory.at_times(times, true, stamps)
        kept = np.flatnonzero(np.isfinite(beside).all(axis=1))
        chosen = [rows[index] for index in kept.tolist()]
        if chosen:
            value, nothing = _measured(quantity.measure, of, chosen, beside[kept])
    return Series(times[-1:], np.array([value])[: len(times)], unit, nothing)


def _measured(measure: str, of: str, rows: Sequence[Row], truth: trajectory.Poses) -> tuple[float, str]:
    matrices = np.array([row.pose for row in rows])
    yaw = np.arctan2(matrices[:, 1, 0], matrices[:, 0, 0])
    estimate = np.column_stack([matrices[:, :2, 3], yaw])
    if bad := int((~np.isfinite(estimate)).any(axis=1).sum()):
        return float("nan"), f"{bad} of {len(rows)} poses of {of} are not finite"
    if measure == "nees":
        if rows[0].covariance is None:
            return float("nan"), f"{of} tells no covariance"
        square = np.array([row.covariance[IN_PLANE] for row in rows])
        return trajectory.nees(estimate, truth, square), f"a covariance of {of} has no inverse"
    if measure.endswith("_aligned"):
        estimate = trajectory.aligned(estimate, truth)
    value = OF[measure.removesuffix("_aligned")](estimate, truth)
    return value, f"the path is shorter than {trajectory.DELTA:g} m"


OF: dict[str, Callable[[trajectory.Poses, trajectory.Poses], float]] = {
    "ate": trajectory.ate,
    "yaw": trajectory.yaw_error,
    "rpe_1m": trajectory.rpe,
}


def chained(fixed: Sequence[Row], moving: Sequence[Row], parent: str, child: str) -> Iterator[Row]:
    """Yields a frame's pose in another at each transform of the nearest moving frame above it.

    Frames further up are where their latest transform before it puts them.

    Args:
        fixed: Transforms of /tf_static.
        moving: Transforms of /tf, by time.
        parent: The frame that poses are given in.
        child: Whose poses.
    """
    latest = {row.child: row for row in fixed}
    trigger, own = child, {row.child for row in moving}
    while trigger not in own and trigger in latest:
        trigger = latest[trigger].parent
    for row in moving:
        latest[row.child] = row
        if row.child == trigger:
            pose, frame = np.eye(4), child
            while frame != parent and frame in latest:
                pose, frame = latest[frame].pose @ pose, latest[frame].parent
            if frame == parent:
                yield Row(row.stamp_ns, parent, child, pose)
