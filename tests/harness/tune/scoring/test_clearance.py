"""min_safe_clearance: the sum that makes it, and the warnings that check it."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from harness.robots import RoverSpec
from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord, Sight, Zone
from harness.tune.scoring import clearance
from harness.tune.scoring.clearance import Braking, measure_braking, study_clearance
from tests.support.rovers import LEO, ROVER_ZERO4WD

MakeRecord = Callable[..., EpisodeRecord]

STOP = Braking(speed=1.0, distance=0.1, time=0.2)  # at 5 m/s^2
LATENCY = 0.1  # [s]: a scan and a control period at 20 Hz


@pytest.mark.parametrize("rover", [LEO, ROVER_ZERO4WD])
def test_a_stop_from_top_speed_takes_what_the_controller_allows(rover: RoverSpec) -> None:
    braking = measure_braking(rover, seed=0)
    assert braking.speed == pytest.approx(rover.top_speed, rel=0.03)
    assert braking.distance == pytest.approx(braking.speed**2 / (2 * rover.linear_acceleration), rel=0.1)
    assert braking.time == pytest.approx(braking.speed / rover.linear_acceleration, rel=0.1)
    if rover is ROVER_ZERO4WD:  # a fast one is stopped from a speed that has room on the floor
        assert measure_braking(rover.but(wheel_speed_limit=80.0), seed=0).speed < 2.1


@pytest.fixture
def stops(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every rover stops as STOP says, without being driven."""
    monkeypatch.setattr(clearance, "measure_braking", lambda _rover, _seed: STOP)


def near_between(
    make_record: MakeRecord, first: float, last: float, contacts: Sequence[tuple[float, float]]
) -> EpisodeRecord:
    """Six seconds at 1 m/s with something 0.3 m away in the scans from first to last [s]."""
    scans = np.arange(1, 121) / 20
    ranges = np.where((scans > first - 0.01) & (scans < last + 0.01), 0.3, 3.0)
    record = make_record(ranges, contacts=contacts)
    record.scans["footprint"] = 0.0
    return record


@pytest.mark.usefixtures("stops")
def test_the_clearance_is_a_sum_rounded_up(
    make_record: MakeRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
    records = dict.fromkeys(Part, [near_between(make_record, 1.0, 2.0, [(2.0, 2.1)])] * 10)
    study = study_clearance(records, LEO, seed=0)
    # 0.218 m to the bumper - 0.174 m to the lidar + 0.1 m latency + 0.1 m braking + 0.1 m margin
    assert study.overhang == pytest.approx(0.044)
    assert study.verdict.tuned is not None
    assert study.verdict.tuned.value == 0.35  # up from 0.344
    assert (study.braking, study.margin) == (STOP, 0.1)
    assert study.verdict.note == (
        "0.044 m from lidar to bumper + 0.100 m in 0.1 s at 1.00 m/s + 0.100 m braking + 0.1 m margin"
    )
    assert study.verdict.tuned.scores[Part.TEST]["recall"].value == 1.0
    monkeypatch.setattr(clearance, "measure_braking", lambda *_: replace(STOP, distance=0.117))
    longer = study_clearance(records, LEO, seed=0).verdict.tuned
    assert longer is not None
    assert longer.value == 0.37  # up from 0.361


@pytest.mark.parametrize(
    ("warned", "contact_s", "expected"),
    [  # contacts, those warned of in time, warnings, those that a contact followed
        ((1.0, 1.5), 1.25, (1, 1, 1, 1)),  # the warning comes 0.25 s before: 0.2 s are needed
        ((1.0, 1.5), 1.15, (1, 0, 1, 1)),
        ((1.0, 1.5), 3.5, (1, 1, 1, 1)),  # two seconds after it ended
        ((1.0, 1.5), 3.55, (1, 0, 1, 0)),
        ((1.0, 1.5), 0.95, (1, 0, 1, 0)),  # before the warning
        ((1.0, 1.5), 1.0, (1, 0, 1, 1)),
        ((9.0, 9.0), 2.0, (1, 0, 0, 0)),
    ],
)
def test_a_warning_counts_if_it_comes_in_time_and_a_contact_follows(
    make_record: MakeRecord,
    warned: tuple[float, float],
    contact_s: float,
    expected: tuple[int, int, int, int],
) -> None:
    record = near_between(make_record, *warned, [(contact_s, contact_s + 0.1)])
    other = make_record([3.0] * 20)
    counts = clearance._counts(STOP, [record, other], np.array([0.1, 0.5]))
    assert counts[1].tolist() == [[*expected, 0.006], [0, 0, 0, 0, 0.001]]
    assert counts[0, :, 1:4].tolist() == [[0, 0, 0]] * 2


@pytest.mark.parametrize(
    ("changed", "contacts"),
    [
        ({}, 1),
        ({"zone": Zone.SIDE}, 0),
        ({"sight": Sight.TOO_LOW}, 0),
        ({"speed": 0.05}, 0),
        ({"speed": 0.06}, 1),
    ],
)
def test_only_contacts_ahead_that_were_seen_while_moving_could_have_been_avoided(
    make_record: MakeRecord, changed: dict[str, object], contacts: int
) -> None:
    record = near_between(make_record, 1.0, 2.0, [(2.0, 2.1)])
    for column, value in changed.items():
        record.events[column] = value
    counts = clearance._counts(STOP, [record], np.array([0.5]))[0, 0]
    assert counts[:2].tolist() == [contacts, contacts]
    assert counts[3] == 1  # any contact makes a warning right


@pytest.mark.usefixtures("stops")
def test_five_contacts_ahead_are_needed_to_check_it(make_record: MakeRecord) -> None:
    record = near_between(make_record, 1.0, 2.0, [(2.0, 2.1), (2.0, 2.1)])
    record.events["zone"][1] = Zone.SIDE
    few, enough = (
        study_clearance({Part.TRAIN: [record], Part.TEST: [record] * ahead}, LEO, seed=0).verdict.lack
        for ahead in (4, 5)
    )
    what = "contacts ahead with hazards that the lidar saw in the test episodes"
    assert (few, enough) == (f"4 {what}; 5 are needed to check it", None)
