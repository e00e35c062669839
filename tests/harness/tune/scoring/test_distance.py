"""distance_threshold: above every step that a rover can make, below the jump of a reset."""

from collections.abc import Callable

import pytest

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring.distance import study_distance
from tests.support.rovers import ROVER_ZERO4WD

MakeRecord = Callable[..., EpisodeRecord]


def seconds(stride: float, from_start: float, count: int = 20) -> list[dict[str, float]]:
    step = {"largest_step": stride / 5, "largest_stride": stride, "from_start": from_start}
    return [step] * count


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
