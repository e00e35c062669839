"""rough_terrain_threshold and smoothness_threshold: choosing and judging."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from harness.tuning.felt import SIGNALS, current_smoothness, peak_acceleration
from harness.tuning.ground import study_ground
from harness.tuning.plan import Part
from harness.tuning.record import EpisodeRecord
from harness.tuning.words import judgement

MakeRecord = Callable[..., EpisodeRecord]
ROUGH, SMOOTH = 0.006, 0.001  # [m]


def both(records: Sequence[EpisodeRecord]) -> dict[Part, Sequence[EpisodeRecord]]:
    return dict.fromkeys(Part, records)


def seconds(peak: float, roughness: float, count: int = 30, **more: float) -> list[dict[str, float]]:
    values = {"peak_acceleration": peak, "mean_smoothness": peak, "roughness": roughness}
    return [values | more for _ in range(count)]


def test_it_finds_the_acceleration_that_separates_the_classes(make_record: MakeRecord) -> None:
    rough = [make_record([], windows=seconds(11.5, ROUGH), terrain="gravel") for _ in range(10)]
    smooth = [make_record([], windows=seconds(10.0, SMOOTH), terrain="flat") for _ in range(10)]
    study = study_ground(both([*rough, *smooth]), SIGNALS[0])

    assert study.verdict.value is not None
    assert 10.0 <= study.verdict.value < 11.5
    assert study.auc[Part.CHECKING].value == pytest.approx(1.0)
    assert "is wrong for leo" in judgement("leo", study.verdict)


def test_a_signal_that_says_nothing_has_an_area_of_one_half(make_record: MakeRecord) -> None:
    rng = np.random.default_rng(0)
    records = [
        make_record(
            [], windows=[s for r in (ROUGH, SMOOTH) for s in seconds(rng.uniform(10, 20), r, 1)] * 10
        )
        for _ in range(60)
    ]
    for record in records:
        record.windows["peak_acceleration"] = rng.uniform(10, 20, len(record.windows))
    study = study_ground(both(records), SIGNALS[0])

    auc = study.auc[Part.CHECKING]
    assert auc.value == pytest.approx(0.5, abs=0.05)
    assert auc.low is not None
    assert auc.high is not None
    assert auc.low < 0.5 < auc.high


@pytest.mark.parametrize("roughness", [ROUGH, SMOOTH])
def test_one_class_supports_no_value(make_record: MakeRecord, roughness: float) -> None:
    records = [make_record([], windows=seconds(11.0, roughness)) for _ in range(20)]
    study = study_ground(both(records), SIGNALS[0])

    assert study.verdict.value is None
    assert "50 s of each are needed" in judgement("leo", study.verdict)
    assert all(part.best is None for part in study.speed_bins)


@pytest.mark.parametrize("touch", [{"contact": 1.0}, {"rocks": 0.2}, {"speed": 0.01}])
def test_what_the_height_map_does_not_explain_is_left_out(
    make_record: MakeRecord, touch: dict[str, float]
) -> None:
    record = make_record([], windows=[*seconds(11.0, ROUGH, 3), *seconds(40.0, SMOOTH, 2, **touch)])

    assert peak_acceleration(record).signal == pytest.approx([11.0] * 3)


def test_current_smoothness_is_the_mean_of_five_seconds(make_record: MakeRecord) -> None:
    windows = [*seconds(10.0, SMOOTH, 4), *seconds(20.0, ROUGH, 1), *seconds(10.0, SMOOTH, 1)]

    felt = current_smoothness(make_record([], windows=windows))

    assert felt.signal == pytest.approx([12.0, 12.0])
    assert current_smoothness(make_record([], windows=windows[:4])).signal.size == 0


def test_speed_shifts_the_best_threshold(make_record: MakeRecord) -> None:
    def classes(speed: float, rough_peak: float) -> list[dict[str, float]]:
        rough = seconds(rough_peak, ROUGH, speed=speed)
        return [*rough, *seconds(rough_peak - 2.0, SMOOTH, speed=speed)]

    records = [make_record([], windows=[*classes(0.1, 12.0), *classes(0.7, 22.0)]) for _ in range(10)]
    study = study_ground(both(records), SIGNALS[0])

    slow, fast = study.speed_bins[0], study.speed_bins[-1]
    assert slow.best is not None
    assert fast.best is not None
    assert slow.best < 12.0
    assert fast.best >= 20.0
