import array
import csv
import io
import itertools
import math
import random
from collections.abc import Sequence
from dataclasses import asdict, replace
from statistics import fmean
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rover_metrics.core.columns import COLUMNS, Row
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.core.rotation import Vector3
from rover_metrics.core.thresholds import Thresholds

STILL = (0.0, 0.0, 0.0)
INF = math.inf
NAN = math.nan


@pytest.fixture
def metrics() -> TraversalMetrics:
    return TraversalMetrics()


def csv_line(row: Row) -> str:
    text = io.StringIO(newline="")
    csv.writer(text).writerow(row.as_fields())
    return text.getvalue()


def test_the_row_before_any_sample_is_roboterrains_to_the_byte(metrics: TraversalMetrics) -> None:
    expected = "1737047098,0,0,0.0,0,inf,0.0,0,0,0,0,Normal operation\r\n"
    assert csv_line(metrics.row(1737047098)) == expected
    assert (metrics.clearance, metrics.farthest) == (INF, -INF)


def test_a_mean_of_zero_is_a_float_and_an_empty_window_an_integer(metrics: TraversalMetrics) -> None:
    metrics.add_odometry(STILL)
    metrics.add_imu(STILL, STILL)
    assert csv_line(metrics.row(0)) == "0,0,0,0.0,0.0,inf,0.0,0.0,0.0,0,0.0,Normal operation\r\n"


def test_extended_cells_follow_the_twelve_and_none_is_empty(metrics: TraversalMetrics) -> None:
    row = replace(metrics.row(3), extended={"Way [m]": None, "Share": 0.123456, "Count": 0})
    assert row.columns == (*COLUMNS, "Way [m]", "Share", "Count")
    assert row.as_fields() == (*metrics.row(3).as_fields(), "", 0.1235, 0)
    big = Row(3, 4, 1, 1.00005, 2.123449, 1 / 3, 0.0, 10.0, 1e16, 0, 9.8, "note, with comma")
    assert csv_line(big) == '3,4,1,1.0001,2.1234,0.3333,0.0,10.0,1e+16,0,9.8,"note, with comma"\r\n'


class History:
    """Everything that was ever given, and RoboTerrain's definitions of the columns over it."""

    def __init__(self, thresholds: Thresholds) -> None:
        self.thresholds = thresholds
        self.scans: list[list[float]] = []
        self.imu: list[tuple[float, float, float]] = []  # |a|, |w|, az
        self.path: list[Vector3] = []
        self.speeds: list[float] = []

    def row(self) -> dict[str, object]:
        limits = self.thresholds
        nearest = [min(scan) for scan in self.scans]
        clearance = fmean(nearest[-100:]) if nearest else INF
        steps = [math.dist(*pair) for pair in itertools.pairwise(self.path)]
        accel, _, vertical = self.imu[-1] if self.imu else (0.0, 0.0, 0.0)
        smoothness = [a + w for a, w, _ in self.imu]
        return {
            "stamp_s": 7,
            "total_collisions": sum(value < limits.collision_threshold for value in nearest),
            "collision_status": int(clearance < limits.collision_threshold),
            "smoothness_metric": pytest.approx(sum(smoothness), rel=1e-12),
            "current_smoothness": pytest.approx(fmean(smoothness[-100:] or [0.0]), rel=1e-12),
            "obstacle_clearance": pytest.approx(clearance, rel=1e-12),
            "distance_traveled": pytest.approx(
                sum(s for s in steps if s < limits.distance_threshold), rel=1e-12
            ),
            "current_velocity": pytest.approx(fmean(self.speeds[-100:] or [0.0]), rel=1e-12),
            "imu_acceleration_magnitude": accel,
            "is_rough_terrain": int(accel > limits.rough_terrain_threshold),
            "vertical_roughness": abs(vertical),
            "notes": "Normal operation",
        }


LIMITS = Thresholds(0.5, 1.0, 1.5, 2.5, 7.0)
# Quadruples of Pythagoras: magnitudes are exact, and some are at a threshold.
VECTORS: list[Vector3] = [
    (0.0, 0.0, 0.0),
    *itertools.permutations((2.0, 3.0, -6.0), 3),  # 7
    *itertools.permutations((-1.0, 4.0, 8.0), 3),  # 9
    *itertools.permutations((1.0, 2.0, -2.0), 3),  # 3
    *itertools.permutations((0.0, 1.5, 2.0), 3),  # 2.5
]
RANGES = (NAN, INF, -INF, -1.0, 0.0, 0.25, 0.5, 0.5, 0.75, 1.25, 9.5)


@pytest.mark.parametrize("limits", [LIMITS, Thresholds(collision_threshold=0.75)])
def test_every_column_is_what_its_definition_says_of_all_samples_so_far(limits: Thresholds) -> None:
    rng = random.Random(5)  # noqa: S311 - no secrets here
    metrics, history = TraversalMetrics(limits), History(limits)
    for number in range(900):
        if number == 450:  # from here on the mean of a window passes the threshold
            ranges: Sequence[float] = (0.25, 0.5)
        elif number < 450:
            ranges = RANGES
        kind = rng.randrange(4) if number else 0
        if kind == 0:
            # The first is at the threshold, and so is the mean then.
            scan = rng.choices(ranges, k=rng.randrange(5)) if number else [limits.collision_threshold]
            finite = [value for value in scan if math.isfinite(value)]
            assert metrics.add_scan(scan) is bool(finite)
            history.scans += [finite] if finite else []
            if history.scans:
                assert metrics.clearance == min(history.scans[-1])
                assert metrics.farthest == max(history.scans[-1])
        elif kind == 1:
            a, w = rng.choice(VECTORS), rng.choice(VECTORS)
            assert metrics.add_imu(a, w)
            history.imu.append((math.dist(a, STILL), math.dist(w, STILL), a[2]))
        elif kind == 2:
            at = rng.choice(VECTORS)
            position = history.path[-1] if history.path and number % 3 else STILL
            position = (position[0] + at[0], position[1] + at[1], position[2] + at[2])
            assert metrics.add_pose(position)
            history.path.append(position)
            assert metrics.last_step == (math.dist(*history.path[-2:]) if history.path[1:] else 0.0)
        else:
            velocity = rng.choice(VECTORS)
            assert metrics.add_odometry(velocity)
            history.speeds.append(math.dist(velocity, STILL))
        assert asdict(metrics.row(7)) == {**history.row(), "extended": {}}
    assert all(len(kept) > 150 for kept in (history.scans, history.imu, history.path, history.speeds))


def test_ranges_count_as_a_message_would_carry_them_in_whatever_container_they_come() -> None:
    """As float32: 0.2 is a little more there, and so no collision."""
    rng = np.random.default_rng(1)
    scans = rng.uniform(0.2, 10.0, (150, 64)).astype(np.float32)
    scans[7, 0] = 0.2
    scans.setflags(write=False)
    containers = (lambda s: s, lambda s: array.array("f", s.tobytes()), lambda s: s.tolist())
    rows = []
    for container in containers:
        metrics = TraversalMetrics()
        for scan in scans:
            assert metrics.add_scan(container(scan))
        metrics.add_scan([0.2, 1 / 3])
        assert [metrics.clearance, metrics.farthest] == np.array([0.2, 1 / 3], np.float32).tolist()
        rows.append(metrics.row(1))
    assert rows[0] == rows[1] == rows[2]
    nearest = [*scans[-99:].min(axis=1).astype(np.float64), np.float32(0.2)]
    assert rows[0].total_collisions == 0
    assert rows[0].obstacle_clearance == pytest.approx(np.mean(nearest))


def test_new_thresholds_hold_for_what_follows(metrics: TraversalMetrics) -> None:
    metrics.add_scan([0.75])
    metrics.add_imu((5.0, 0.0, 0.0), STILL)
    limits = {"collision_threshold": 1.0, "rough_terrain_threshold": 4.0, "distance_threshold": 2.0}
    metrics.thresholds = Thresholds(**limits)
    assert (metrics.row(0).collision_status, metrics.row(0).is_rough_terrain) == (1, 0)
    metrics.add_scan([0.75])
    metrics.add_imu((5.0, 0.0, 0.0), STILL)
    metrics.add_pose(STILL)
    metrics.add_pose((1.5, 0.0, 0.0))
    row = metrics.row(0)
    assert (row.total_collisions, row.is_rough_terrain, row.distance_traveled) == (1, 1, 1.5)


# Whatever the sensors say

BOUNDS = {"acceleration": 1e5, "rate": 1e4, "speed": 1e4, "pose": math.inf}


def give(metrics: TraversalMetrics, kind: str, vector: Vector3) -> bool:
    if kind == "pose":
        return metrics.add_pose(vector)
    if kind == "speed":
        return metrics.add_odometry(vector)
    return metrics.add_imu(*((vector, STILL) if kind == "acceleration" else (STILL, vector)))


ANY_FLOAT = st.floats() | st.sampled_from([NAN, INF, -INF, 1e308, -1e308]) | st.floats(-9.0, 9.0)
ANY_RANGES = st.lists(st.floats(width=32) | st.sampled_from([NAN, INF, -INF, 0.0, -1.0]), max_size=8)


@settings(max_examples=60)
@given(
    st.lists(
        ANY_RANGES | st.tuples(st.sampled_from([*BOUNDS]), st.tuples(*[ANY_FLOAT] * 3)), max_size=40
    )
)
def test_only_what_is_finite_and_possible_is_used_and_sums_never_fall(samples: list[Any]) -> None:
    metrics = TraversalMetrics()
    before = metrics.row(0)
    for sample in samples:
        if isinstance(sample, list):
            usable = metrics.add_scan(np.array(sample, dtype=np.float32))
            assert usable is any(map(math.isfinite, sample))
        else:
            usable, size = give(metrics, *sample), math.hypot(*sample[1])
            assert usable is (size <= BOUNDS[sample[0]] and math.isfinite(size))
        row = metrics.row(0)
        assert usable or row == before
        assert all(math.isfinite(float(cell)) for cell in row.as_fields()[1:11] if cell != INF)
        assert (row.smoothness_metric, row.distance_traveled) < (INF, INF)
        for name in ("total_collisions", "smoothness_metric", "distance_traveled"):
            assert getattr(row, name) >= getattr(before, name)
        before = row


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("kind", ["acceleration", "rate", "speed"])
def test_the_largest_values_are_taken_and_what_is_beyond_them_is_not(kind: str, axis: int) -> None:
    for size in (BOUNDS[kind], -BOUNDS[kind]):
        for factor, taken in ((1.0, True), (1.00001, False), (NAN, False)):
            x, y, z = (factor * size if each == axis else 0.0 for each in range(3))
            assert give(TraversalMetrics(), kind, (x, y, z)) is taken
