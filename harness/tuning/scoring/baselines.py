"""Contacts by side of the rover, and those that no threshold can tell because the lidar saw nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.tuning.episodes.record import EpisodeRecord, Sight, Zone
from harness.tuning.scoring.alarms import Detector, alarms, matches


@dataclass(frozen=True, slots=True)
class UnseenContacts:
    """Contacts that the lidar could not know of, for one reason."""

    sight: Sight
    contacts: int


@dataclass(frozen=True, slots=True)
class ZoneRow:
    """Contacts on one side with hazards that the lidar saw.

    Attributes:
        detected: How many of them each detector tells, by its name.
    """

    zone: Zone
    contacts: int
    detected: Mapping[str, int]


def unseen_contacts(records: Sequence[EpisodeRecord]) -> tuple[UnseenContacts, ...]:
    """Returns contacts without a finite return of what was touched, by reason."""
    sights = _all(records, "sight")
    return tuple(
        UnseenContacts(sight, int(np.count_nonzero(sights == sight)))
        for sight in Sight
        if sight is not Sight.SEEN
    )


def zone_rows(
    records: Sequence[EpisodeRecord], detectors: Mapping[str, tuple[Detector, float]]
) -> tuple[ZoneRow, ...]:
    """Returns how many contacts of each side each detector tells.

    Args:
        records: The episodes.
        detectors: A detector and its threshold [m], by name.
    """
    zones, seen = _all(records, "zone"), _all(records, "sight") == Sight.SEEN
    detected = {name: _detected(records, *detector) for name, detector in detectors.items()}
    return tuple(
        ZoneRow(
            zone,
            int(np.count_nonzero(here)),
            {name: int(np.count_nonzero(told & here)) for name, told in detected.items()},
        )
        for zone in Zone
        for here in [seen & (zones == zone)]
    )


def _detected(
    records: Sequence[EpisodeRecord], detector: Detector, threshold: float
) -> NDArray[np.bool_]:
    each = [
        matches(record, alarms(record, detector(record), threshold)).any(axis=0) for record in records
    ]
    return np.concatenate(each) if each else np.empty(0, dtype=bool)


def _all(records: Sequence[EpisodeRecord], column: str) -> NDArray[np.str_]:
    each = [record.events[column] for record in records]
    return np.concatenate(each) if each else np.empty(0, dtype="U1")
