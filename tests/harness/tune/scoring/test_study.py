"""What a study takes of a sweep, and what it says of it in sentences."""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from harness.tune.episodes.plan import Part, plan
from harness.tune.episodes.record import Ending, EpisodeRecord, Sight
from harness.tune.scoring.choose import Candidate, Verdict
from harness.tune.scoring.collision import UnseenContacts
from harness.tune.scoring.estimate import Estimate
from harness.tune.scoring.study import driven, judgement, scored_records, unreachable

if TYPE_CHECKING:
    from tests.harness.tune.conftest import Sweep

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
    assert scored == {Part.TRAIN: [1.0, 3.0], Part.TEST: [2.0, 4.0, 6.0]}  # in their order
    leo = driven("leo", records)
    assert leo.endings == {Ending.COMPLETE: 4, Ending.DIVERGED: 1, Ending.TIPPED_OVER: 1}
    assert (leo.seconds, leo.path_length) == (16.0, 16.0)


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


@pytest.mark.parametrize(
    ("low", "gain", "words"),
    [
        (None, (0.0, 0.0, 0.0), "stays for leo, because the data support no value: no contacts."),
        (0.65, (0.2, -0.1, 0.3), "stays for leo, for nothing better is proven: "),
        (0.65, (0.2, 0.05, 0.3), "is wrong for leo: "),
        (0.65, (0.02, 0.004, 0.049), "is a little worse than it could be for leo: "),
        (0.65, (0.04, 0.03, 0.05), "is worse than it could be for leo: "),
        (0.55, (0.2, 0.1, 0.3), "is worse than 0.3 m for leo: "),
    ],
)
def test_a_default_is_as_bad_as_the_whole_interval_of_the_gain_says(
    low: float | None, gain: tuple[float, float, float], words: str
) -> None:
    tuned = None if low is None else Estimate(0.7, low, 0.8)
    sentence = judgement("leo", verdict(tuned, Estimate(*gain), "a note"))
    assert sentence.startswith(f"collision_threshold: the default 0.2 m {words}")
    if tuned is not None:
        digits = 3 if gain[1] == 0.004 else 2
        assert f"against {tuned.text(digits)} with 0.3 m (a note)" in sentence
        assert ("the intervals do not overlap" in sentence) is (low == 0.65 and gain[1] > 0)


@pytest.mark.parametrize(
    ("contacts", "unseen", "words"),
    [
        (0, (0, 0, 0), "No contact took place"),
        (7, (0, 0, 0), "The lidar saw every one of the 7 hazards that were touched"),
        (1, (0, 0, 0), "The lidar saw the hazard that was touched"),
        (1, (1, 0, 0), r"1 of 1 contact \(100 %\)"),
        (16, (3, 0, 1), r"4 of 16 contacts \(25 %\).*: 3 below the lidar, 1 out of its plane\.$"),
    ],
)
def test_contacts_that_no_threshold_tells_are_counted_by_reason(
    contacts: int, unseen: tuple[int, ...], words: str, small_sweep: "Sweep"
) -> None:
    reasons = (Sight.TOO_LOW, Sight.TOO_NEAR, Sight.MISSED)
    spots = tuple(map(UnseenContacts, reasons, unseen))
    study = replace(small_sweep[0][0].collision, contacts=contacts, unseen_contacts=spots)
    assert re.search(words, unreachable(study))
