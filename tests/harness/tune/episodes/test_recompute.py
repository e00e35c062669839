"""Samples as rows: what a scan and a second come down to."""

import math

import numpy as np
import pytest

from harness.base.sim_time import TICK_NS
from harness.episode.batch import Batch
from harness.samples import Imu, LaserScan, Pose, Tick, TruthState
from harness.truth.traversal import Truth
from harness.tune.episodes.recompute import Collected, scan_rows, window_rows
from tests.support.rovers import ROVER_ZERO4WD

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
MS = 1_000_000


def state(stamp_ms: int, *, speed: float = 0.0, **more: bool | float) -> TruthState:
    values = {
        "hazard_contact": False,
        "rock_contact": False,
        "path_length": 0.0,
        "roughness": 0.0,
    } | more
    return TruthState(
        stamp_ns=stamp_ms * MS,
        scrape=False,
        contact_force=0.0,
        speed=speed,
        slip=(0.0, 0.0, 0.0, 0.0),
        **values,  # type: ignore[arg-type]  # of four types
    )


def test_a_scan_is_its_nearest_return_its_near_returns_and_its_way_to_the_outline() -> None:
    # Of 5 beams the middle one looks along the lidar's x axis, which is backwards.
    scans = [
        LaserScan(50 * MS, np.array([np.inf, -np.inf, 2.0, -np.inf, 3.0], np.float32)),
        LaserScan(100 * MS, np.full(5, np.inf, np.float32)),
    ]
    states = [state(50, speed=0.5, hazard_contact=True), state(100, speed=-0.25)]

    rows = scan_rows(Collected(scans=scans, states=states), ROVER_ZERO4WD)

    assert rows["stamp_ms"].tolist() == [50, 100]
    assert rows["nearest"].tolist() == [2.0, np.inf]
    assert rows["near_returns"].tolist() == [2, 0]
    # The lidar is 0.174 m ahead of the origin, the rear end 0.272 m behind it.
    assert rows["footprint"].tolist() == pytest.approx([2.0 - 0.174 - 0.272, np.inf], abs=1e-3)
    assert rows["contact"].tolist() == [True, False]
    assert rows["speed"].tolist() == [0.5, -0.25]
    assert len(scan_rows(Collected(), ROVER_ZERO4WD)) == 0


@pytest.fixture
def two_seconds() -> Collected:
    """Ten samples of each kind a second; those on the full second belong to the one that ends there."""
    stamps = range(100, 2600, 100)
    collected = Collected()
    for ms in stamps:
        first = ms <= 1000
        peak = {900: 14.0, 1000: 12.0, 1100: 20.0}.get(ms, 10.0)
        collected.imu.append(
            Imu(ms * MS, UPRIGHT, (0.0, 0.0, 5.0 if ms == 500 else 1.0), (0.0, 0.6 * peak, 0.8 * peak))
        )
        collected.states.append(
            state(
                ms,
                speed=-0.5 if ms % 200 else 0.7,
                roughness=0.004 if first else 0.002,
                rock_contact=ms in {100, 1000, 1100},
                hazard_contact=ms == 1000,
            )
        )
    # 0.3 m a pose along x, but for a step of 0.5 m up at 1.0 s.
    for number, ms in enumerate(stamps):
        collected.poses.append(Pose(ms * MS, (0.3 * number, 2.0, 0.5 * (ms >= 1000)), UPRIGHT))
    return collected


def test_a_second_is_the_extrema_and_means_of_what_was_sampled_up_to_its_end(
    two_seconds: Collected,
) -> None:
    rows = window_rows(two_seconds)

    assert len(rows) == 2  # full ones
    expected = {
        "time_s": (1.0, 2.0),
        "peak_acceleration": (14.0, 20.0),
        "mean_smoothness": ((7 * 11.0 + 15.0 + 15.0 + 13.0) / 10, (9 * 11.0 + 21.0) / 10),
        "peak_smoothness": (15.0, 21.0),
        "speed": (0.6, 0.6),  # backwards is as fast as forwards
        "roughness": (0.004, 0.002),
        "rocks": (0.2, 0.1),
        "contact": (True, False),
        "largest_step": (math.hypot(0.3, 0.5), 0.3),
        "largest_stride": (math.hypot(1.5, 0.5), math.hypot(1.5, 0.5)),
        "from_start": (math.hypot(2.7, 0.5), math.hypot(5.7, 0.5)),
    }
    for column, values in expected.items():
        assert rows[column].tolist() == pytest.approx(values, abs=1e-5), column


def test_samples_are_sorted_by_kind_and_the_last_state_tells_the_path() -> None:
    scan, pose, other = LaserScan(0, np.zeros(2, np.float32)), Pose(0, (0, 0, 0), UPRIGHT), state(50)
    imu, last = Imu(0, UPRIGHT, (0, 0, 0), (0, 0, 0)), state(100, path_length=3.5)
    collected = Collected()

    assert collected.path_length == 0.0
    collected.take(Batch((Tick(0, (imu, scan, other)), Tick(TICK_NS, (pose, last))), Truth()))

    assert (collected.imu, collected.poses, collected.states) == ([imu], [pose], [other, last])
    assert collected.scans == [scan]
    assert collected.path_length == 3.5


def test_a_scan_stands_at_the_pose_nearest_in_time() -> None:
    poses = [Pose(ms * MS, (float(ms), 0.0, 0.0), UPRIGHT) for ms in (20, 40, 60, 80)]
    scans = [LaserScan(ms * MS, np.zeros(2, np.float32)) for ms in (1, 29, 31, 60, 99)]

    placed = Collected(scans=scans, poses=poses).placed_scans()

    assert [item.scan.stamp_ns // MS for item in placed] == [1, 29, 31, 60, 99]
    assert [item.pose.position[0] for item in placed] == [20.0, 20.0, 40.0, 60.0, 80.0]
