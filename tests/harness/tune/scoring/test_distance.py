"""distance_threshold: above every step that a rover can make, below the jump of a reset."""

from collections.abc import Callable

import pytest

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring.distance import study_distance
from tests.support.rovers import LEO, ROVER_ZERO4WD

MakeRecord = Callable[..., EpisodeRecord]


def seconds(stride: float, from_start: float, count: int = 20) -> list[dict[str, float]]:
    step = {"largest_step": stride / 5, "largest_stride": stride, "from_start": from_start}
    return [step] * count


def test_the_step_threshold_is_above_every_possible_step(make_record: MakeRecord) -> None:
    windows = [*seconds(0.1, 0.3), *seconds(0.1, 8.0)]
    other = make_record([], windows=seconds(0.125, 0.3, 40))
    records = {
        Part.TRAIN: [make_record([], windows=windows) for _ in range(10)],
        Part.TEST: [make_record([], windows=windows) for _ in range(9)] + [other],
    }
    study = study_distance(records, ROVER_ZERO4WD)

    assert study.possible_step == pytest.approx(10.0 * 0.127 * 0.1)  # top speed over 5 poses at 50 Hz
    assert study.largest_stride == pytest.approx(0.125)
    assert study.largest_step == pytest.approx(0.025)
    assert study.verdict.tuned is not None
    # From the first hundredth of a metre above the possible step to the jumps of 0.3 m all is alike.
    assert study.verdict.tuned.value == 0.22  # of 0.13 to 0.30 the upper of the middle two
    default = study.verdict.default.scores[Part.TRAIN]
    assert {name: score.value for name, score in default.items()} == pytest.approx(
        {"balanced accuracy": 0.75, "false accept rate": 0.5, "false reject rate": 0.0}
    )


def test_a_step_as_long_as_the_threshold_is_refused_and_no_travel(make_record: MakeRecord) -> None:
    # Powers of two, so that no rounding is in the way.
    windows = [*seconds(0.5, 9.0, 60), *seconds(0.25, 0.25, 20), *seconds(0.25, 0.5, 20)]
    records = [make_record([], windows=windows)]
    study = study_distance(dict.fromkeys(Part, records), ROVER_ZERO4WD)

    scores = study.verdict.default.scores[Part.TEST]

    assert study.verdict.default.value == 0.5
    assert scores["false reject rate"].value == pytest.approx(0.6)
    assert scores["false accept rate"].value == pytest.approx(0.2)
    assert scores["balanced accuracy"].value == pytest.approx(0.6)
    assert study.verdict.tuned is not None
    assert study.verdict.tuned.value == 0.75  # of 0.51 to 0.99
    assert study.verdict.note == "for poses at 50 Hz, four in a row of which may be lost"


@pytest.mark.parametrize(
    ("count", "lack"),
    [(100, None), (99, "99 s of poses in the test episodes; 100 are needed")],
)
def test_a_hundred_seconds_of_each_part_are_needed(
    make_record: MakeRecord, count: int, lack: str | None
) -> None:
    enough = make_record([], windows=seconds(0.1, 5.0, 100))
    records = {
        Part.TRAIN: [enough],
        Part.TEST: [make_record([], windows=seconds(0.1, 5.0, n)) for n in (50, count - 50)],
    }

    assert study_distance(records, LEO).verdict.lack == lack
