"""collision_threshold: choosing and judging."""

from collections.abc import Callable

import numpy as np
import pytest

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring.collision import study_collisions
from harness.tune.scoring.study import judgement

MakeRecord = Callable[..., EpisodeRecord]
AtDistance = Callable[..., list[EpisodeRecord]]


@pytest.fixture
def at(make_record: MakeRecord) -> AtDistance:
    """Ten episodes in each of which the rover comes to a distance, with or without touching."""

    def make(distance: float, *, touches: bool, count: int = 10, **more: object) -> list[EpisodeRecord]:
        ranges = np.concatenate([np.linspace(3.0, distance, 40), np.linspace(distance, 3.0, 40)])
        contacts = [(2.0, 2.1)] if touches else []
        return [make_record(ranges, contacts=contacts, **more) for _ in range(count)]

    return make


@pytest.mark.parametrize(
    ("footprint", "near", "switch", "threshold"),
    [
        (0.5, 1, True, None),  # only near returns tell the touch: no threshold adds to them
        (0.09, 0, None, 0.15),  # the default of 0.05 m is too small, and nothing is too near
        (0.04, 0, None, None),  # the defaults tell everything
        (0.04, -1, None, None),  # and near returns, of what is passed, would only be false alarms
    ],
)
def test_the_footprints_parameters_are_compared_with_their_defaults(
    at: AtDistance, footprint: float, near: int, switch: bool | None, threshold: float | None
) -> None:
    touching, passing = at(0.225, touches=True), at(0.35, touches=False)
    for record in touching:
        record.scans["footprint"] = 0.6
        record.scans["footprint"][38:42] = footprint
        record.scans["near_returns"][38:42] = near > 0
    for record in passing:
        record.scans["footprint"] = 0.6
        record.scans["footprint"][38:42] = 0.2
        record.scans["nearest"][38:42] = 0.03
        record.scans["near_returns"][38:42] = near < 0
    study = study_collisions(dict.fromkeys(Part, (*touching, *passing)))
    switched, tuned = study.footprint
    assert (switched.name, switched.default.value is False) == ("near_returns_as_contact", True)
    assert (tuned.name, tuned.default.value, tuned.unit) == ("footprint_threshold", 0.05, "m")
    assert (switched.value, tuned.value) == (switch, threshold)
    at_default = (float(footprint < 0.05), float(near > 0 or footprint < 0.05))
    defaults = (one.default.scores[Part.TEST]["F1"].value for one in (switched, tuned))
    assert tuple(defaults) == at_default
    assert switched.note == tuned.note == "read with extended_columns:=true"


def test_a_value_that_fails_on_unseen_episodes_is_not_written(at: AtDistance) -> None:
    chosen_on = [*at(0.3, touches=True), *at(0.5, touches=False)]
    checked_on = [*at(0.19, touches=True), *at(0.25, touches=False)]
    study = study_collisions({Part.TRAIN: chosen_on, Part.TEST: checked_on})
    assert study.verdict.tuned is not None
    assert study.verdict.value is None
    assert "nothing better is proven" in judgement("rover", study.verdict)


def test_too_few_contacts_support_no_value(at: AtDistance) -> None:
    records = [*at(0.225, touches=True, count=9), *at(0.35, touches=False)]
    study = study_collisions(dict.fromkeys(Part, records))
    assert (study.verdict.value, study.detectors) == (None, ())
    assert {verdict.lack for verdict in study.footprint} == {study.verdict.lack}
    assert "9 contacts with hazards in the train episodes" in judgement("r", study.verdict)
