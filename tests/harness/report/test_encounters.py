"""Where people and rover met."""

import pytest

from harness.report import encounters as module
from harness.report.encounters import Encounter, encounters
from harness.report.recorder import Approach
from tests.harness.report.made import stretches


def at(time_s: float, *distances: float) -> dict[str, tuple[Approach, ...]]:
    return {"approaches": tuple(Approach(d, time_s, (time_s, 0.0), (time_s, d)) for d in distances)}


def test_each_time_that_somebody_was_near_has_its_nearest_moment() -> None:
    far = [3.6, 3.0, 2.0, 2.5, 9.0, 3.5, 3.6]
    track = stretches({}, *(at(2.0 + i, d, 20.0 - i) for i, d in enumerate(far)))
    assert [(e.person, e.nearest.distance, e.nearest.time_s, e.near_s) for e in encounters(track)] == [
        (0, 2.0, 4.0, 3.0),
        (0, 3.5, 7.0, 1.0),
        (1, 14.0, 8.0, 0.0),  # never near: the nearest of the run
    ]
    assert encounters(stretches({}, {})) == []


def test_of_many_the_nearest_are_kept_and_one_of_each_person(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_ENCOUNTERS", 3)
    far = [3.0, 9.0, 1.0, 9.0, 2.0, 9.0, 2.5]
    track = stretches(*(at(1.0 + i, d, 30.0) for i, d in enumerate(far)))
    kept: list[Encounter] = encounters(track)
    assert [(e.person, e.nearest.distance) for e in kept] == [(1, 30.0), (0, 1.0)]
    monkeypatch.setattr(module, "MOST_ENCOUNTERS", 4)
    assert [e.nearest.distance for e in encounters(track)] == [30.0, 1.0, 2.0]
