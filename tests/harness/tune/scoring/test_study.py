"""What a study takes of a sweep, and what it says of it in sentences."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import pytest

from harness.tune.episodes.plan import Part, Planned, plan
from harness.tune.episodes.record import Ending, EpisodeRecord, Sight
from harness.tune.scoring.collision import CollisionStudy, DetectorStudy, UnseenContacts
from harness.tune.scoring.estimate import Estimate
from harness.tune.scoring.result import Candidate, Verdict
from harness.tune.scoring.study import (
    Driven,
    RobotStudy,
    _driven,
    alternatives,
    conclusions,
    judgement,
    scored_records,
    unreachable,
)
from tests.support.rovers import LEO, ROVER_ZERO4WD

MakeRecord = Callable[..., EpisodeRecord]


def test_what_diverged_is_counted_but_not_scored(make_record: MakeRecord) -> None:
    planned = plan(("leo",), 6, 0, 5.0)
    endings = [*[Ending.COMPLETE] * 4, Ending.DIVERGED, Ending.TIPPED_OVER]
    of_another = replace(planned[0], run=planned[0].run.alone(robot="rover_zero4wd"))
    records = {of_another: make_record([3.0])} | {
        planned[n]: replace(make_record([3.0] * 20 * (n + 1)), ending=endings[n])
        for n in range(5, -1, -1)
    }

    parts = scored_records("leo", records)
    scored = {part: [record.duration for record in parts[part]] for part in Part}
    driven = _driven("leo", records)

    assert scored == {Part.TRAIN: [1.0, 3.0], Part.TEST: [2.0, 4.0, 6.0]}  # in their order
    assert driven.endings == {Ending.COMPLETE: 4, Ending.DIVERGED: 1, Ending.TIPPED_OVER: 1}
    assert (driven.seconds, driven.path_length) == (16.0, 16.0)


def test_a_study_judges_every_threshold_of_its_robot_in_the_order_of_the_page(
    small_sweep: tuple[Sequence[RobotStudy], Mapping[Planned, EpisodeRecord]],
) -> None:
    (leo, zero), records = small_sweep
    assert [verdict.name for verdict in leo.verdicts] == [
        *("collision_threshold", "near_returns_as_contact", "footprint_threshold"),
        *("min_safe_clearance", "rough_terrain_threshold", "smoothness_threshold"),
        "distance_threshold",
    ]
    for made, rover in ((leo, LEO), (zero, ROVER_ZERO4WD)):
        own = [record for one, record in records.items() if one.run.rover.robot == rover.name]
        assert (made.robot, made.name) == (rover.name, rover.name)
        assert made.driven.endings == {Ending.COMPLETE: len(own)}
        assert made.driven.seconds == pytest.approx(sum(record.duration for record in own))
        assert made.distance.possible_step == pytest.approx(rover.top_speed * 0.1)
        assert made.clearance.overhang == pytest.approx(rover.footprint[1] - rover.lidar_x)
        told = list(conclusions(made))
        assert [line.partition(":")[0] for line in told[:7]] == [v.name for v in made.verdicts]
        assert told[7] == unreachable(made.collision)
        assert told[8:] == list(alternatives(made.collision))
    assert len(leo.collision.detectors) == 4


def test_what_was_driven_is_told_in_minutes_and_kilometres() -> None:
    driven = Driven(
        endings={Ending.TIPPED_OVER: 1, Ending.COMPLETE: 3}, seconds=630.0, path_length=1234.0
    )

    # 10.5 rounds to even.
    assert driven.text() == "10 min and 1.23 km scored; 3 complete, 1 tipped over"


def verdict(tuned: Estimate | None, gain: Estimate, note: str = "") -> Verdict:
    def candidate(value: float, score: Estimate) -> Candidate:
        return Candidate(
            value=value, scores={Part.TRAIN: {"F1": Estimate(0.99)}, Part.TEST: {"F1": score}}
        )

    return Verdict(
        name="collision_threshold",
        unit="m",
        measure="F1",
        default=candidate(0.2, Estimate(0.5, 0.4, 0.6)),
        tuned=None if tuned is None else candidate(0.3, tuned),
        gain={"F1": gain},
        lack="no contacts" if tuned is None else None,
        note=note,
    )


def test_a_default_stays_where_the_data_support_no_value() -> None:
    assert judgement("leo", verdict(None, Estimate(0.0))) == (
        "collision_threshold: the default 0.2 m stays for leo, because the data support no value: "
        "no contacts."
    )


OVERLAP = "; the intervals overlap, but on the same"


@pytest.mark.parametrize(
    ("low", "gain", "judged", "end"),
    [
        (0.65, (0.2, -0.1, 0.3), "stays for leo, for nothing better is proven", "; on the same"),
        (0.65, (0.2, 0.05, 0.3), "is wrong for leo", ""),
        (0.65, (0.2, 0.049, 0.3), "is worse than it could be for leo", ""),
        (0.65, (0.02, 0.004, 0.049), "is a little worse than it could be for leo", ""),
        (0.65, (0.04, 0.03, 0.05), "is worse than it could be for leo", ""),
        (0.55, (0.2, 0.1, 0.3), "is worse than 0.3 m for leo", OVERLAP),
    ],
)
def test_a_verdict_in_a_sentence(low: float, gain: tuple[float, ...], judged: str, end: str) -> None:
    digits = 3 if gain[1] == 0.004 else 2
    default, tuned, difference = (
        f"{value:.{digits}f} ({least:.{digits}f} to {most:.{digits}f})"
        for value, least, most in ((0.5, 0.4, 0.6), (0.7, low, 0.8), gain)
    )
    end = f"{end} episodes the difference is {difference}." if end else "; the intervals do not overlap."
    for note, told in (("", ""), ("a note", " (a note)")):
        assert judgement("leo", verdict(Estimate(0.7, low, 0.8), Estimate(*gain), note)) == (
            f"collision_threshold: the default 0.2 m {judged}: F1 {default} against {tuned} "
            f"with 0.3 m{told} on unseen seeds{end}"
        )


def collision(
    contacts: int, *spots: UnseenContacts, detectors: tuple[DetectorStudy, ...] = ()
) -> CollisionStudy:
    found = verdict(None, Estimate(0.0))
    default = DetectorStudy(name="nearest range", events=found.default, scans={}, lead_s=None)
    return CollisionStudy(
        verdict=found,
        footprint=(found, found),
        default=default,
        detectors=detectors,
        zones=(),
        unseen_contacts=spots,
        contacts=contacts,
    )


def test_contacts_that_no_threshold_tells_in_a_sentence() -> None:
    assert unreachable(collision(0)) == "No contact took place in the episodes that check."
    assert unreachable(collision(7, UnseenContacts(Sight.MISSED, 0))) == (
        "The lidar saw every one of the 7 hazards that were touched."
    )
    reasons = map(UnseenContacts, (Sight.TOO_LOW, Sight.TOO_NEAR, Sight.MISSED), (3, 0, 1))
    assert unreachable(collision(16, *reasons)) == (
        "No threshold can tell 4 of 16 contacts (25 %), for the lidar did not see the hazard: "
        "3 below the lidar, 1 out of its plane."
    )


def test_what_the_other_detectors_buy_in_sentences() -> None:
    scores = {
        "F1": Estimate(0.8, 0.7, 0.9),
        "recall": Estimate(0.6),
        "false alarms per km": Estimate(3.14, 2.71, 4.0),
    }
    worse = dict.fromkeys(scores, Estimate(0.1))
    events = Candidate(value=0.05, scores={Part.TRAIN: worse, Part.TEST: scores})
    other = DetectorStudy(name="footprint clearance", events=events, scans={}, lead_s=None)
    first = replace(other, name="nearest range")

    assert list(alternatives(collision(9, detectors=(first, other)))) == [
        (
            "Footprint clearance below 0.05 m: F1 0.80 (0.70 to 0.90), recall 0.60 "
            "(too few episodes for an interval), 3.1 (2.7 to 4.0) false alarms per km."
        )
    ]
