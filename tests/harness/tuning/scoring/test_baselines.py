"""Contacts by side, and those that the lidar could not know of."""

from collections.abc import Callable

import pytest

from harness.tuning.episodes.record import EpisodeRecord, Sight, Zone
from harness.tuning.scoring.alarms import footprint_clearance, nearest_range
from harness.tuning.scoring.baselines import UnseenContacts, ZoneRow, unseen_contacts, zone_rows

MakeRecord = Callable[..., EpisodeRecord]

CONTACTS = ((0.5, 0.6), (2.0, 2.1), (3.5, 3.6))


@pytest.fixture
def records(make_record: MakeRecord) -> list[EpisodeRecord]:
    """Three contacts each; only the first and, by the footprint, the second are told."""
    near = [0.1 if n in {9, 10} else 3.0 for n in range(80)]
    seen = make_record(near, contacts=CONTACTS)
    seen.scans["footprint"][39] = 0.1
    seen.events["zone"] = (Zone.FRONT, Zone.FRONT, Zone.REAR)
    mixed = make_record(near, contacts=CONTACTS)
    mixed.events["zone"] = (Zone.SIDE, Zone.REAR, Zone.FRONT)
    mixed.events["sight"] = (Sight.SEEN, Sight.TOO_LOW, Sight.MISSED)
    return [seen, mixed]


def test_contacts_that_the_lidar_saw_are_counted_by_side_and_detector(
    records: list[EpisodeRecord],
) -> None:
    detectors = {"range": (nearest_range, 0.2), "outline": (footprint_clearance, 0.2)}

    assert zone_rows(records, detectors) == (
        ZoneRow(Zone.FRONT, 2, {"range": 1, "outline": 2}),
        ZoneRow(Zone.SIDE, 1, {"range": 1, "outline": 1}),
        ZoneRow(Zone.REAR, 1, {"range": 0, "outline": 0}),
    )


def test_contacts_that_it_did_not_see_are_counted_by_reason(records: list[EpisodeRecord]) -> None:
    assert unseen_contacts(records) == (
        UnseenContacts(Sight.TOO_LOW, 1),
        UnseenContacts(Sight.TOO_NEAR, 0),
        UnseenContacts(Sight.MISSED, 1),
    )


def test_without_episodes_there_are_no_contacts() -> None:
    assert [row.contacts for row in zone_rows([], {"range": (nearest_range, 0.2)})] == [0, 0, 0]
    assert [spot.contacts for spot in unseen_contacts([])] == [0, 0, 0]
