"""The extended columns, from samples to cells."""

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from rover_metrics.extended.imu_columns import GRAVITY
from rover_metrics.extended.metrics import ExtendedMetrics
from rover_metrics.extended.row import EXTENDED_HEADER
from rover_metrics.extended.settings import ExtendedSettings
from rover_metrics.extended.traffic_columns import SCAN
from rover_metrics.footprint import Footprint, LidarPose
from rover_metrics.metrics import TraversalMetrics, Vector3
from rover_metrics.row import COLUMNS
from rover_metrics.thresholds import Thresholds

SQUARE = ExtendedSettings(footprint=Footprint.rectangle(-0.2, 0.2, -0.2, 0.2))
LEVEL = (0.001, 0.0, 0.0, math.sqrt(1 - 1e-6))  # but filled in


class Feed:
    """Gives samples to both kinds of metrics, as the node does."""

    def __init__(self, settings: ExtendedSettings = SQUARE) -> None:
        self.metrics = TraversalMetrics(Thresholds())
        self.extended = ExtendedMetrics(self.metrics, settings)

    def scan(self, t: float, *ranges: float) -> None:
        used = self.metrics.add_scan(ranges)
        self.extended.add_scan(ns(t), ranges, angle_min=0.0, angle_increment=math.pi / 2, used=used)

    def imu(self, t: float, a: Vector3, orientation: Any = LEVEL) -> None:  # noqa: ANN401
        used = self.metrics.add_imu(a, (0.0, 0.0, 0.0))
        self.extended.add_imu(ns(t), a, orientation, used=used)

    def pose(self, t: float, x: float, y: float = 0.0) -> None:
        used = self.metrics.add_pose((x, y, 0.0))
        self.extended.add_pose(ns(t), (x, y, 0.0), used=used)

    def odometry(self, t: float, speed: float) -> None:
        used = self.metrics.add_odometry((speed, 0.0, 0.0))
        self.extended.add_odometry(ns(t), (speed, 0.0, 0.0), used=used)

    def row(self, t: float = 1.0, **kwargs: Any) -> dict[str, Any]:  # noqa: ANN401
        row = self.extended.row(ns(t), **kwargs)
        return dict(zip(row.columns, row.as_fields(), strict=True))


def ns(seconds: float) -> int:
    return round(seconds * 1e9)


def times(rate: float, start: float = 0.0, seconds: float = 1.0) -> Iterator[float]:
    """Stamps at a rate, up to and including the end."""
    return (start + i / rate for i in range(1, round(rate * seconds) + 1))


def test_a_row_is_the_twelve_columns_and_then_the_extended_ones() -> None:
    feed = Feed()
    feed.scan(0.5, 1.0)
    row = feed.extended.row(ns(7.5))
    assert row.columns == EXTENDED_HEADER
    assert row.columns[:12] == COLUMNS
    assert row.as_fields()[:12] == feed.metrics.row(7).as_fields()
    assert len(row.as_fields()) == len(EXTENDED_HEADER)
    assert row.stamp_s == 7


def test_what_never_spoke_leaves_empty_cells_never_zeros() -> None:
    assert set(list(Feed().row().values())[12:]) == {""}


# Lidar


def test_a_lasting_collision_is_one_event_and_one_after_a_pause_another() -> None:
    feed = Feed()
    touches = [0.5, 0.55, 0.6, 1.05, 1.1, 2.0]  # 0.45 s apart is the same, 0.9 s is not
    for t in times(20, seconds=2.5):
        feed.scan(t, 0.16 if any(math.isclose(t, touch) for touch in touches) else 3.0)
    row = feed.row()
    assert (row["Total Collisions"], row["Collision Events"]) == (6, 2)


def test_a_scan_after_the_clock_went_back_begins_another_event() -> None:
    feed = Feed()
    for t in (5.0, 5.05, 0.05, 0.1):
        feed.scan(t, 0.16)
    assert feed.row()["Collision Events"] == 2


def test_near_returns_are_counted_by_scan_whatever_else_the_scan_says() -> None:
    feed = Feed()
    feed.scan(0.1, -math.inf, -math.inf)
    feed.scan(0.2, -math.inf, 3.0)
    feed.scan(0.3, math.inf, 3.0)
    assert feed.row()["Near Return Scans"] == 2


def test_footprint_clearance_is_the_smallest_of_the_second_and_counts_touches() -> None:
    feed = Feed()
    feed.scan(0.1, 0.5, 3.0)  # ahead
    feed.scan(0.2, 3.0, 0.24)  # to the left, 4 cm
    row = feed.row()
    assert (row["Footprint Clearance [m]"], row["Footprint Collisions"]) == (0.04, 1)
    feed.scan(1.1, 0.5, 3.0)
    row = feed.row()
    assert (row["Footprint Clearance [m]"], row["Footprint Collisions"]) == (0.3, 1)
    assert feed.row()["Footprint Clearance [m]"] == ""  # no scan in that second
    feed.scan(3.1, math.inf, math.inf)
    assert feed.row()["Footprint Clearance [m]"] == math.inf


def test_without_a_footprint_its_columns_are_empty() -> None:
    feed = Feed(ExtendedSettings())
    feed.scan(0.1, 0.16)
    row = feed.row()
    assert (row["Footprint Clearance [m]"], row["Footprint Collisions"]) == ("", "")
    assert row["Collision Events"] == 1


def test_the_lidars_pose_and_near_returns_are_used_as_they_are_set() -> None:
    settings = ExtendedSettings(
        footprint=SQUARE.footprint, lidar_pose=LidarPose(0.1, 0.0, math.pi), near_returns_as_contact=True
    )
    feed = Feed()
    feed.extended.use(settings)
    feed.scan(0.1, 0.5, 3.0)  # it looks backwards
    assert feed.row()["Footprint Clearance [m]"] == 0.2
    feed.scan(1.1, -math.inf, 3.0)
    assert feed.row()["Footprint Clearance [m]"] == 0.0


# IMU


def tilted(roll: float, pitch: float) -> tuple[tuple[float, float, float, float], Vector3]:
    """An orientation, and the specific force at rest in it: gravity's opposite in the IMU frame."""
    sr, cr, sp, cp = math.sin(roll / 2), math.cos(roll / 2), math.sin(pitch / 2), math.cos(pitch / 2)
    up = (-math.sin(pitch), math.sin(roll) * math.cos(pitch), math.cos(roll) * math.cos(pitch))
    x, y, z = (GRAVITY * value for value in up)
    return (sr * cp, cr * sp, -sr * sp, cr * cp), (x, y, z)


@pytest.mark.parametrize(("roll", "pitch"), [(0.0, 0.3), (0.5, 0.0), (-0.4, 0.7), (3.0, 0.2)])
def test_at_rest_roughness_is_zero_on_every_slope(roll: float, pitch: float) -> None:
    feed = Feed()
    orientation, force = tilted(roll, pitch)
    for t in times(20):
        feed.imu(t, force, orientation)
    assert feed.row()["Roughness RMS [m/s^2]"] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("orientation", [None, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 0.0)])
def test_without_an_orientation_gravity_is_what_lasts(orientation: object) -> None:
    feed = Feed()
    _, force = tilted(0.3, 0.5)
    for t in times(20):
        feed.imu(t, force, orientation)
    assert feed.row()["Roughness RMS [m/s^2]"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("orientation", [LEVEL, None])
@pytest.mark.parametrize("rate", [50, 100, 400])
def test_roughness_of_a_shaking_is_its_rms_at_any_rate(rate: float, orientation: object) -> None:
    feed = Feed()
    for t in times(rate, seconds=10.0):
        feed.imu(t, (0.0, 0.0, GRAVITY + 3.0 * math.sin(math.tau * 5.0 * t)), orientation)
    assert feed.row()["Roughness RMS [m/s^2]"] == pytest.approx(3.0 / math.sqrt(2.0), rel=0.02)


def test_peak_jerk_is_the_steepest_change_of_the_force_as_a_vector() -> None:
    feed = Feed()
    feed.imu(0.1, (0.0, 0.0, 9.8))
    feed.imu(0.2, (0.0, 0.0, 9.8))
    feed.imu(0.3, (9.8, 0.0, 0.0))  # of the same magnitude
    feed.imu(0.3, (50.0, 0.0, 0.0))  # a stamp that stands still tells no time
    feed.imu(5.0, (0.0, 0.0, 0.0))  # nor does a gap
    assert feed.row()["Peak Jerk [m/s^3]"] == pytest.approx(9.8 * math.sqrt(2.0) / 0.1, abs=1e-3)
    feed.imu(5.1, (1.0, 0.0, 0.0))
    assert feed.row()["Peak Jerk [m/s^3]"] == 10.0


# Motion


def test_vort_is_the_speed_while_rough_in_whatever_order_the_topics_arrive() -> None:
    rough, smooth = (0.0, 0.0, 20.0), (0.0, 0.0, 9.8)
    samples: list[Callable[[Feed], None]] = [
        lambda feed: feed.imu(0.1, smooth),
        lambda feed: feed.odometry(0.1, 9.0),
        lambda feed: feed.odometry(0.3, 1.0),
        lambda feed: feed.odometry(0.4, 2.0),
        lambda feed: feed.imu(0.3, rough),
        lambda feed: feed.imu(0.5, smooth),
        lambda feed: feed.odometry(0.5, 9.0),
    ]
    for order in (samples, samples[::-1]):
        feed = Feed()
        for give in order:
            give(feed)
        assert feed.row()["VORT [m/s]"] == 1.5


def test_vort_goes_on_from_the_verdict_of_the_second_before_and_is_empty_on_smooth_terrain() -> None:
    feed = Feed()
    feed.imu(0.9, (0.0, 0.0, 20.0))
    assert feed.row()["VORT [m/s]"] == ""  # no speed yet
    feed.odometry(1.1, 0.5)
    assert feed.row()["VORT [m/s]"] == 0.5
    feed.imu(2.05, (0.0, 0.0, 9.8))
    feed.odometry(2.1, 0.5)
    assert feed.row()["VORT [m/s]"] == ""


@pytest.mark.parametrize(
    ("wheels", "speed", "slip"), [(0.5, 0.5, 0.0), (0.5, 0.25, 0.5), (0.25, 0.5, -0.5), (0.01, 0.0, 0.0)]
)
@pytest.mark.parametrize("rate", [10, 50])
def test_slip_compares_wheels_and_pose(wheels: float, speed: float, slip: float, rate: float) -> None:
    feed = Feed()
    for t in times(rate, seconds=2.0):
        feed.pose(t, speed * t)
        feed.odometry(t, wheels)
        if math.isclose(t, 1.0):
            feed.row()
    assert feed.row()["Slip"] == pytest.approx(slip, abs=1e-4)


def test_a_jump_of_the_pose_is_neither_slip_nor_path() -> None:
    feed = Feed()
    for t, x in ((0.1, 0.0), (0.2, 0.1), (0.3, 50.0), (0.4, 50.1)):
        feed.pose(t, x)
        feed.odometry(t, 1.0)
    row = feed.row()
    assert row["Slip"] == 0.0
    assert row["Path Efficiency"] == 1.0


def test_path_efficiency_is_one_on_a_line_and_zero_on_a_round_trip() -> None:
    feed = Feed()
    for t in range(5):
        feed.pose(t, 0.1 * t)
    assert feed.row()["Path Efficiency"] == 1.0
    for t in range(1, 5):
        feed.pose(4 + t, 0.4 - 0.1 * t)
    assert feed.row()["Path Efficiency"] == 0.0


# Topics


def test_rate_and_age_tell_of_a_topic_that_slows_down_and_stops() -> None:
    feed = Feed()
    for t in times(20):
        feed.scan(t, 1.0)
    assert feed.row(1.0)["Scan Rate [Hz]"] == ""  # since when?
    feed.scan(1.25, 1.0)
    row = feed.row(2.0)
    assert (row["Scan Rate [Hz]"], row["Scan Age [s]"]) == (1.0, 0.75)
    row = feed.row(3.0)
    assert (row["Scan Rate [Hz]"], row["Scan Age [s]"]) == (0.0, 1.75)


@pytest.mark.parametrize("stamp", [0.0, 1.7e9])
def test_age_is_empty_without_stamps_or_with_those_of_another_clock(stamp: float) -> None:
    feed = Feed()
    feed.scan(stamp, 1.0)
    assert feed.row(2.0)["Scan Age [s]"] == ""


def test_rejected_and_lost_messages_are_counted() -> None:
    feed = Feed()
    for t in times(20):
        feed.imu(t, (math.nan, 0.0, 9.8) if t > 0.9 else (0.0, 0.0, 9.8))
    assert feed.row(1.0)["IMU Rejected"] == 2
    for t in (1.05, 1.10, 1.30, 1.35):
        feed.imu(t, (0.0, 0.0, 9.8))
    row = feed.row(2.0)
    assert (row["IMU Lost"], row["IMU Rejected"], row["Scan Lost"]) == (3, 2, "")


def test_what_the_middleware_reports_lost_is_not_counted_on_top_of_the_gaps() -> None:
    feed = Feed()
    for t in times(20):
        feed.scan(t, 1.0)
    feed.row(1.0)
    feed.scan(1.2, 1.0)
    assert feed.row(2.0, reported_lost={SCAN: 2})["Scan Lost"] == 3
    assert feed.row(3.0, reported_lost={SCAN: 5})["Scan Lost"] == 5


# Truth


def test_true_contacts_are_events_and_a_share() -> None:
    feed = Feed()
    for message in range(40):  # 20 Hz: a touch, 0.4 s later the same one, 0.6 s after that another
        feed.extended.add_contact(touches=message in {2, 3, 12, 24})
    row = feed.row()
    assert (row["True Contact Events"], row["True Contact Share"]) == (2, 0.1)
    feed.extended.add_contact(touches=False)
    assert feed.row()["True Contact Share"] == 0.0
    assert feed.row()["True Contact Share"] == ""


def test_true_speed_is_empty_while_nobody_fills_the_twist_in() -> None:
    feed = Feed()
    assert feed.extended.add_true_velocity((0.0, 0.0, 0.0))
    assert feed.row()["True Speed [m/s]"] == ""
    assert feed.extended.add_true_velocity((0.3, 0.4, 0.0))
    assert feed.extended.add_true_velocity((0.0, 0.0, 0.0))
    assert not feed.extended.add_true_velocity((math.nan, 0.0, 0.0))
    assert feed.row()["True Speed [m/s]"] == 0.25


def test_slips_and_roughness_are_read_by_their_names() -> None:
    names = ["roughness", "slip_rear_right", "slip_front_right", "slip_rear_left", "slip_front_left"]
    feed = Feed()
    assert feed.extended.add_traversal([0.01, 0.4, 0.3, 0.2, 0.1], names)
    assert feed.extended.add_traversal([0.03, 0.4, 0.3, 0.2, 0.1], names)
    row = feed.row()
    assert [row[f"True Slip {w}"] for w in ("Front Left", "Rear Left", "Front Right", "Rear Right")] == [
        0.1,
        0.2,
        0.3,
        0.4,
    ]
    assert row["True Roughness [m]"] == 0.02


@pytest.mark.parametrize("values", [[], [1.0] * 9, [math.nan] * 10])
def test_another_truth_is_refused(values: list[float]) -> None:
    assert not Feed().extended.add_traversal(values)


def test_a_clock_that_stands_still_for_hours_costs_no_memory() -> None:
    feed = Feed()
    for t in np.arange(30_000) / 20.0:
        feed.odometry(float(t), 1.0)
        feed.imu(float(t), (0.0, 0.0, 20.0))
    travel = feed.extended._travel
    assert len(travel._speeds) == len(travel._rough) == 10_000
    assert feed.row()["VORT [m/s]"] == 1.0
