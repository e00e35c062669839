"""Faults of one reading by itself."""

import math
from dataclasses import astuple

import numpy as np
import pytest

from harness.base.sim_time import TICK_NS as TICK
from harness.faults.injector import FaultInjector
from harness.samples import (
    GroundTruth,
    Imu,
    JointStates,
    LaserScan,
    Odometry,
    Pose,
    Sample,
    Tick,
    Twist,
)
from tests.harness.faults.faulty_ticks import UPRIGHT, imus, readings, scans, sent, times
from tests.support.words import parse_faults


@pytest.mark.parametrize("share", [0.3, 0.005])
def test_share_of_beams_is_hit_at_random(share: float) -> None:
    found = scans(f"scan:nan={share}")
    hit = np.isnan([scan.ranges for scan in found])
    rng = np.random.default_rng(np.random.SeedSequence(0, spawn_key=(11, 0)))
    np.testing.assert_array_equal(hit, rng.random(hit.shape) < share)
    assert all(scan.ranges.dtype == np.float32 for scan in found)


def test_spike_throws_one_value_in_ten_off_to_both_sides() -> None:
    off = np.array([s.ranges - round(s.stamp_ns / TICK) for s in scans("scan:spike=3")])
    assert set(np.unique(off).tolist()) == {-3.0, 0.0, 3.0}
    hits = np.abs(off) / 3.0
    assert hits.mean() == pytest.approx(0.1, abs=0.02)
    assert hits.sum(axis=1).var() == pytest.approx(10 * 0.1 * 0.9, abs=0.2)  # each by itself
    assert (np.ptp(off, axis=1) == 6.0).any()  # to its own side


@pytest.mark.parametrize(
    ("sensor", "expected"),
    [
        ("imu", Imu(TICK, UPRIGHT, (7.0,) * 3, (7.0,) * 3)),
        ("pose", Pose(TICK, (7.0,) * 3, UPRIGHT)),
        ("odometry", Odometry(TICK, 7.0, 7.0, 0.5, Twist(7.0, 7.0))),
        ("ground_truth", GroundTruth(TICK, 7.0, 7.0, 0.5, (7.0,) * 3, (7.0,) * 3)),
        ("joint_states", JointStates(TICK, (7.0,) * 3, (7.0,) * 3, (7.0,) * 3)),
        ("imu.attitude", Imu(TICK, (7.0,) * 4, (1.0,) * 3, (1.0,) * 3)),
        ("pose.attitude", Pose(TICK, (1.0,) * 3, (7.0,) * 4)),
        ("odometry.attitude", Odometry(TICK, 1.0, 1.0, 7.0, Twist(1.0, 1.0))),
        ("ground_truth.attitude", GroundTruth(TICK, 1.0, 1.0, 7.0, (1.0,) * 3, (1.0,) * 3)),
    ],
)
def test_everything_measured_is_hit_and_no_attitude_or_that_alone(sensor: str, expected: Sample) -> None:
    specs = (f"{sensor}:stuck=7", f"{sensor}:nan@3")
    (found,) = readings(sent(*specs, seconds=0.01), type(expected))
    assert found == expected


def test_a_twist_keeps_its_axes() -> None:
    """Values that differ: forward must not become yaw."""
    faults = FaultInjector(parse_faults(["odometry:spike=0.25"]), 0)
    clean = Odometry(TICK, 1.0, 2.0, 3.0, Twist(4.0, 5.0))
    found = [faults.corrupt(Tick(TICK, (clean,))).samples[0] for _ in range(200)]
    read = np.array([(o.x, o.y, o.yaw, *astuple(o.twist)) for o in found if isinstance(o, Odometry)])
    off = read - (1.0, 2.0, 3.0, 4.0, 5.0)
    assert set(np.unique(off)) == {-0.25, 0.0, 0.25}
    assert off.any(axis=0).tolist() == [True, True, False, True, True]


def test_stamps_shift_but_never_below_zero_or_stand_still() -> None:
    assert times(imus("imu:stamp-shift=-0.5@0.2+0.4"))[18:61:20] == [0.19, 0.0, 0.09]
    stands = imus("imu:stamp-freeze@1+1")
    assert times(stands)[98:201:50] == [0.99, 0.99, 0.99]
    assert [imu.angular_velocity[0] for imu in stands] == [float(n) for n in range(1, 401)]
    assert imus("imu:stamp-shift=2.01")[0].stamp_ns == 2_020_000_000  # to the nearest nanosecond


def test_empty_messages_hold_no_readings() -> None:
    one = sent("scan:empty", "pose:empty", "joint_states:empty")[0]
    _, scan, _, pose, _, _, joints, *_ = one.samples
    assert isinstance(scan, LaserScan)
    assert scan.ranges.size == 0
    assert isinstance(pose, Pose)
    assert pose.empty
    assert np.isnan(pose.position).all()
    assert isinstance(joints, JointStates)
    assert (joints.position, joints.velocity, joints.effort) == ((), (), ())


def test_beams_are_cut_or_added() -> None:
    whole = [float(beam) for beam in range(10)]
    one = Tick(TICK, (LaserScan(TICK, np.array(whole, np.float32)),))
    for beams, expected in ((0, []), (3, whole[:3]), (10, whole), (12, [*whole, math.inf, math.inf])):
        (scan,) = FaultInjector(parse_faults([f"scan:beams={beams}"]), 0).corrupt(one).samples
        assert isinstance(scan, LaserScan)
        assert scan.ranges.tolist() == expected
        assert scan.ranges.dtype == np.float32
