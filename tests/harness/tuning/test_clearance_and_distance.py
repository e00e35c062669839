"""min_safe_clearance and distance_threshold."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from harness.robots import LEO, ROVER_ZERO4WD, RoverSpec
from harness.tuning.braking import LATENCY, Braking, measure_braking
from harness.tuning.clearance import MARGIN, study_clearance
from harness.tuning.distance import study_distance
from harness.tuning.plan import Part
from harness.tuning.record import EpisodeRecord, Zone

MakeRecord = Callable[..., EpisodeRecord]


def both(records: Sequence[EpisodeRecord]) -> dict[Part, Sequence[EpisodeRecord]]:
    return dict.fromkeys(Part, records)


@pytest.mark.parametrize("rover", [LEO, ROVER_ZERO4WD])
def test_a_stop_from_top_speed_takes_what_the_controller_allows(rover: RoverSpec) -> None:
    braking = measure_braking(rover, seed=0)

    assert braking.speed == pytest.approx(rover.top_speed, rel=0.03)
    assert braking.distance == pytest.approx(braking.speed**2 / (2 * rover.linear_acceleration), rel=0.1)
    assert braking.time == pytest.approx(braking.speed / rover.linear_acceleration, rel=0.2)


@pytest.mark.parametrize("speed", [0.3, 1.0])
def test_a_warning_must_come_as_early_as_the_stopping_distance_takes(speed: float) -> None:
    braking = Braking(speed=1.0, distance=0.1, time=0.2)  # 5 m/s^2

    stopping_distance = speed * LATENCY + speed**2 / (2 * 5.0)

    assert braking.needed_lead(speed) == pytest.approx(stopping_distance / speed)


def approaching(make_record: MakeRecord, zone: Zone = Zone.FRONT) -> EpisodeRecord:
    """At 1 m/s towards a wall, which the front touches when it is 0.094 m from the lidar."""
    ranges = np.linspace(3.0, 0.1, 59)
    return make_record(ranges, contacts=[(2.9, 3.0)], zone=zone)


def test_the_clearance_is_the_sum_of_its_parts_and_warns_in_time(make_record: MakeRecord) -> None:
    records = both([approaching(make_record)] * 10)
    study = study_clearance(records, ROVER_ZERO4WD, seed=0)

    braking, tuned = study.braking, study.verdict.tuned
    assert study.overhang == pytest.approx(0.268 - 0.174)
    assert tuned is not None
    expected = study.overhang + braking.speed * LATENCY + braking.distance + MARGIN
    assert expected <= tuned.value < expected + 0.01
    assert tuned.scores[Part.CHECKING]["recall"].value == 1.0


def test_a_contact_beside_is_none_that_braking_could_have_avoided(make_record: MakeRecord) -> None:
    records = both([approaching(make_record, Zone.SIDE)] * 10)
    study = study_clearance(records, LEO, seed=0)

    assert np.isnan(study.verdict.default.scores[Part.CHECKING]["recall"].value)
    assert study.verdict.value is None
    assert "0 contacts ahead" in (study.verdict.lack or "")


def seconds(stride: float, from_start: float, count: int = 20) -> list[dict[str, float]]:
    return [
        {"largest_step": stride / 5, "largest_stride": stride, "from_start": from_start}
        for _ in range(count)
    ]


def test_the_step_threshold_is_above_every_possible_step(make_record: MakeRecord) -> None:
    windows = [*seconds(0.1, 0.3), *seconds(0.1, 8.0)]
    records = both([make_record([], windows=windows) for _ in range(10)])
    study = study_distance(records, ROVER_ZERO4WD)

    assert study.possible_step == pytest.approx(ROVER_ZERO4WD.top_speed * 0.1)
    assert study.largest_stride == pytest.approx(0.1)
    assert study.verdict.value is not None
    assert study.possible_step <= study.verdict.value <= 0.3
    default, tuned = study.verdict.default, study.verdict.tuned
    assert default.scores[Part.CHECKING]["false accept rate"].value == pytest.approx(0.5)
    assert tuned is not None
    assert tuned.scores[Part.CHECKING]["false accept rate"].value == 0.0


def test_a_few_seconds_support_no_value(make_record: MakeRecord) -> None:
    records = both([make_record([], windows=seconds(0.1, 5.0, 9))])

    assert "9 s of poses" in (study_distance(records, LEO).verdict.lack or "")
