"""collision_threshold: choosing and judging."""

from collections.abc import Callable

import numpy as np
import pytest

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord, Sight, Zone
from harness.tune.scoring.alarms import DETECTORS, FOOTPRINT_CLEARANCE, NEAREST_RANGE
from harness.tune.scoring.collision import (
    UnseenContacts,
    ZoneRow,
    _detector_study,
    study_collisions,
    unseen_contacts,
    zone_rows,
)
from harness.tune.scoring.result import Candidate
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


def test_it_finds_the_distance_that_separates_touching_from_passing(at: AtDistance) -> None:
    study = study_collisions(dict.fromkeys(Part, (*at(0.225, touches=True), *at(0.35, touches=False))))

    assert study.verdict.value == 0.29  # the middle of 0.23 to 0.35
    assert study.verdict.is_proven
    assert "is wrong for rover" in judgement("rover", study.verdict)


@pytest.mark.parametrize(
    ("footprint", "near", "switch", "threshold"),
    [
        (0.5, 1, True, None),  # only near returns tell the touch: no threshold adds to them
        (0.09, 0, None, 0.15),  # the default of 0.05 m is too small, and nothing is too near
        (0.04, 0, None, None),  # the defaults tell everything
        (0.04, -1, None, None),  # and near returns, of what is passed, would only be false alarms
    ],
)
def test_near_returns_and_footprint_threshold_are_each_compared_with_their_default(
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
    switched, tuned = study_collisions(dict.fromkeys(Part, (*touching, *passing))).footprint

    assert (switched.name, switched.default.value is False) == ("near_returns_as_contact", True)
    assert (tuned.name, tuned.default.value, tuned.unit) == ("footprint_threshold", 0.05, "m")
    assert (switched.value, tuned.value) == (switch, threshold)
    at_default = (float(footprint < 0.05), float(near > 0 or footprint < 0.05))
    defaults = (one.default.scores[Part.TEST]["F1"].value for one in (switched, tuned))
    assert tuple(defaults) == at_default
    assert switched.note == tuned.note == "read with extended_columns:=true"


def test_every_detector_is_judged_at_its_own_best_where_it_was_not_chosen(at: AtDistance) -> None:
    chosen_on = [*at(0.225, touches=True), *at(0.35, touches=False)]
    checked_on = [
        *at(0.225, touches=True),
        *at(0.265, touches=True, zone=Zone.SIDE),
        *at(0.35, touches=False, count=5),
        *at(3.0, touches=True, count=2, sight=Sight.TOO_LOW),
    ]
    for record in (*chosen_on, *checked_on):
        record.scans["footprint"] = record.scans["nearest"] / 2
    for record in checked_on[:10]:
        record.scans["near_returns"][10] = 1  # 1.45 s before the contact
    study = study_collisions({Part.TRAIN: chosen_on, Part.TEST: checked_on})

    assert [(d.name, d.events.value) for d in study.detectors] == [
        ("nearest range", 0.29),
        ("nearest range, near returns count", 0.29),
        ("footprint clearance", 0.15),
        ("footprint clearance, near returns count", 0.15),
    ]
    precision = [d.events.scores[Part.TEST]["precision"].value for d in study.detectors]
    assert precision == pytest.approx([1.0, 20 / 30, 1.0, 20 / 30])
    assert (study.default.name, study.default.events.value) == ("nearest range", 0.2)
    assert study.default.events.scores[Part.TEST]["recall"].value == 0.0
    assert study.default.lead_s is None
    # Below 0.29 m the ranges come at the 40th scan, 2.0 s, in steps of 7 cm: 0 s before the contact.
    assert study.detectors[0].lead_s == pytest.approx(0.0)
    assert study.detectors[0].scans["recall"].value == pytest.approx(20 / 66)
    assert study.detectors[0].events.scores[Part.TEST]["recall"].value == pytest.approx(20 / 22)
    told = {"default": 0} | dict.fromkeys(DETECTORS, 10)
    none = dict.fromkeys(told, 0)
    sides = (Zone.FRONT, 10, told), (Zone.SIDE, 10, told), (Zone.REAR, 0, none)
    assert study.zones == tuple(ZoneRow(*side) for side in sides)
    assert {spot.sight: spot.contacts for spot in study.unseen_contacts if spot.contacts} == {
        Sight.TOO_LOW: 2
    }
    assert study.contacts == 22


def test_the_lead_is_the_median_over_the_contacts_that_are_found(make_record: MakeRecord) -> None:
    records = []
    for lead_s in (0.0, 0.1, 0.5):
        ranges = [0.1 if 2.0 - lead_s <= scan / 20 <= 2.05 else 3.0 for scan in range(1, 81)]
        records.append(make_record(ranges, contacts=[(2.0, 2.1), (3.5, 3.6)]))
    at = Candidate(value=0.2, scores={})
    study = _detector_study(NEAREST_RANGE, {Part.TRAIN: [], Part.TEST: records}, at)
    assert study.lead_s == pytest.approx(0.1)


def test_a_value_that_fails_on_unseen_episodes_is_not_written(at: AtDistance) -> None:
    chosen_on = [*at(0.3, touches=True), *at(0.5, touches=False)]
    checked_on = [*at(0.19, touches=True), *at(0.25, touches=False)]
    study = study_collisions({Part.TRAIN: chosen_on, Part.TEST: checked_on})

    assert study.verdict.tuned is not None
    assert study.verdict.value is None
    assert "nothing better is proven" in judgement("rover", study.verdict)


@pytest.mark.parametrize("touches", [0, 9])
def test_too_few_contacts_support_no_value(at: AtDistance, touches: int) -> None:
    records = [*at(0.225, touches=True, count=touches), *at(0.35, touches=False)]
    study = study_collisions(dict.fromkeys(Part, records))

    assert study.verdict.value is None
    assert study.detectors == ()
    assert {verdict.lack for verdict in study.footprint} == {study.verdict.lack}
    assert f"{touches} contacts with hazards in the train episodes" in judgement("r", study.verdict)


def test_contacts_that_the_lidar_saw_are_counted_by_side_and_detector_others_by_reason(
    make_record: MakeRecord,
) -> None:
    """Of three contacts each only the first and, by the footprint, the second are told."""
    near = [0.1 if n in {9, 10} else 0.25 for n in range(80)]
    seen, mixed = (make_record(near, contacts=((0.5, 0.6), (2.0, 2.1), (3.5, 3.6))) for _ in range(2))
    seen.scans["footprint"][39] = 0.1
    seen.events["zone"] = (Zone.FRONT, Zone.FRONT, Zone.REAR)
    mixed.events["zone"] = (Zone.SIDE, Zone.REAR, Zone.FRONT)
    mixed.events["sight"] = (Sight.SEEN, Sight.TOO_LOW, Sight.MISSED)
    names = {"range": NEAREST_RANGE, "outline": FOOTPRINT_CLEARANCE}
    detectors = {name: (DETECTORS[detector], 0.25) for name, detector in names.items()}

    assert zone_rows([seen, mixed], detectors) == (
        ZoneRow(Zone.FRONT, 2, {"range": 1, "outline": 2}),
        ZoneRow(Zone.SIDE, 1, {"range": 1, "outline": 1}),
        ZoneRow(Zone.REAR, 1, {"range": 0, "outline": 0}),
    )
    reasons = (Sight.TOO_LOW, Sight.TOO_NEAR, Sight.MISSED)
    assert unseen_contacts([seen, mixed]) == tuple(map(UnseenContacts, reasons, (1, 0, 1)))
    assert zone_rows([], detectors) == tuple(ZoneRow(z, 0, dict.fromkeys(names, 0)) for z in Zone)
    assert unseen_contacts([]) == tuple(UnseenContacts(reason, 0) for reason in reasons)
