"""What becomes of batches: closed forms of hand-made poses, positions and slips."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from harness.episode.batch import Batch
from harness.episode.mission import MissionState
from harness.samples import ActorPoses, Pose, SoilState, Tick, Truth, TruthState
from harness.scenario.quantities import QUANTITIES
from harness.scenario.series import TruthSeries

ANGLES = st.floats(-math.pi, math.pi)

CORNERS = ("front_left", "rear_left", "front_right", "rear_right")


def batch(index: int, *samples: object, **truth: object) -> Batch:
    stamp = index * 50_000_000
    total = Truth(time_ns=stamp, **truth)  # type: ignore[arg-type]  # fields of Truth
    return Batch((Tick(stamp, samples),), total, (), ())  # type: ignore[arg-type]  # samples


@settings(max_examples=30)
@given(ANGLES, st.floats(-1.5, 1.5), ANGLES)
def test_tilt_is_the_angle_between_the_verticals_whatever_the_heading(
    yaw: float, pitch: float, roll: float
) -> None:
    rotation = Rotation.from_euler("ZYX", [yaw, pitch, roll])
    (up,) = rotation.apply([[0.0, 0.0, 1.0]])
    watch = TruthSeries(["truth.tilt_deg"])
    watch.take(batch(1, Pose(0, (0.0, 0.0, 0.0), tuple(rotation.as_quat()))))
    (tilt,) = watch.series()["truth.tilt_deg"].values
    assert math.cos(math.radians(tilt)) == pytest.approx(up[2], abs=1e-9)


def test_a_goal_is_reached_when_it_is_first_near_enough_and_stays_so() -> None:
    watch = TruthSeries(["truth.goal_distance", "truth.goal_s"], (3.0, 4.0, 1.0))
    for index, x in enumerate([0.0, 2.5, 3.0, 0.0], 1):
        watch.take(batch(index, position=(x, 4.0 * x / 3.0, 9.0)))
    series = watch.series()
    assert series["truth.goal_distance"].values == pytest.approx([5.0, 5.0 / 6.0, 0.0, 5.0])
    assert series["truth.goal_s"].values == pytest.approx([math.nan, 0.1, 0.1, 0.1], nan_ok=True)
    assert series["truth.goal_s"].times == pytest.approx([0.05, 0.1, 0.15, 0.2])


def test_a_mission_is_told_when_and_where_the_rover_is_and_of_its_resets() -> None:
    told = list[tuple[object, ...]]()

    class Mission:
        def take(self, *about: object) -> MissionState:
            told.append(about)
            return MissionState(points=7)

    watch = TruthSeries(["truth.route_points"], mission=Mission())  # type: ignore[arg-type]
    watch.take(batch(2, position=(3.0, 4.0, 5.0), resets=2, scrapes=6, hazard_contacts=8))
    assert told == [(0.1, (3.0, 4.0), 2)]
    assert watch.series()["truth.route_points"].values.tolist() == [7.0]


def test_every_quantity_of_the_truth_comes_from_its_own_value() -> None:
    slip = (0.1, 0.5, -0.2, 0.3, 0.6, -0.4)  # of six wheels: corners are the ends of each side
    six = (0.0, 0.3, 0.1, 0.2, 0.6, -0.5)
    soil = SoilState(sinkage=six, slip_angle=six, pull=six, side_force=six, stuck=True)
    state = TruthState(0, True, False, False, 11.0, 0.12, 0.0, slip, 0.013, soil)
    totals = {"path_length": 14.0, "position": (15.0, 16.0, 17.0), "tipped_over": True, "resets": 2}
    counts = {"hazard_contacts": 3, "rock_contacts": 4, "scrapes": 5}
    times = {"hazard_contact_s": 0.6, "rock_contact_s": 0.7, "scrape_s": 0.8}
    watch = TruthSeries(QUANTITIES)
    upright = (0.0, 0.0, 0.0, 1.0)
    people = ActorPoses(0, ((9.0, 9.0, 1.0), (4.0, 5.0, 8.0)), (upright, upright))
    here = Pose(0, (1.0, 1.0, 1.0), upright)
    watch.take(batch(1, state, here, people, **totals, **counts, **times))
    found = {name: float(series.values[0]) for name, series in watch.series().items()}
    expected = {f"truth.{name}": value for name, value in {**counts, **times}.items()} | {
        "truth.contact_force": 11.0,
        "truth.speed": 0.12,
        "truth.roughness": 0.013,
        "truth.path_length": 14.0,
        "truth.x": 15.0,
        "truth.y": 16.0,
        "truth.z": 17.0,
        "truth.tipped_over": 1.0,
        "truth.resets": 2.0,
        "truth.tilt_deg": 0.0,
        "truth.slip": 0.35,
        "truth.slip.front_left": 0.1,
        "truth.slip.rear_left": -0.2,
        "truth.slip.front_right": 0.3,
        "truth.slip.rear_right": -0.4,
        "truth.sinkage": 0.6,
        "truth.slip_angle_deg": math.degrees(1.7 / 6),
        "truth.pull": 0.7,
        "truth.side_force": 1.7,
        "truth.stuck": 1.0,
        **{
            f"truth.{name}.{wheel}": value
            for name in ("sinkage", "slip_angle", "pull", "side_force")
            for wheel, value in zip(CORNERS, (0.0, 0.1, 0.2, -0.5), strict=True)
        },
        "truth.person_distance": 5.0,
        "truth.goal_distance": math.nan,
        "truth.goal_s": math.nan,
        "truth.route_points": 0.0,  # of no mission
        "truth.route_s": math.nan,
        "truth.targets_reached": 0.0,
        "truth.gates_passed": 0.0,
    }
    assert found.keys() == expected.keys()
    assert [found[name] for name in expected] == pytest.approx([*expected.values()], nan_ok=True)


def test_the_latest_state_and_tilt_hold_until_the_next() -> None:
    watch = TruthSeries(QUANTITIES)
    state = TruthState(0, False, False, False, 0.0, 0.5, 0.0, (0.0,) * 4, 0.0)
    watch.take(batch(1))
    roof, wheels = ((1.0, 1e-5, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))  # the larger tilt counts; it is 180 deg
    watch.take(batch(2, state, *(Pose(0, (0.0,) * 3, attitude) for attitude in (roof, wheels))))
    watch.take(batch(3))
    found = {name: series.values.tolist() for name, series in watch.series().items()}
    assert {values[0] for values in found.values() if not math.isnan(values[0])} == {0.0}
    assert found["truth.speed"] == [0.0, 0.5, 0.5]
    assert found["truth.tilt_deg"] == pytest.approx([0.0, 180.0, 180.0])
