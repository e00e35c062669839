"""rough_terrain_threshold and smoothness_threshold: choosing and judging."""

from collections.abc import Callable

import numpy as np
import pytest

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring.ground import (
    SIGNALS,
    ImuEvents,
    current_smoothness,
    peak_acceleration,
    study_ground,
)

MakeRecord = Callable[..., EpisodeRecord]
Seconds = list[dict[str, float]]
ROUGH, SMOOTH = 0.006, 0.001  # [m]


def seconds(peak: float, roughness: float, count: int = 30, **more: float) -> Seconds:
    values = {"peak_acceleration": peak, "mean_smoothness": peak, "roughness": roughness}
    return [values | more for _ in range(count)]


@pytest.mark.parametrize(("rough", "smooth"), [(49, 60), (60, 49), (50, 50)])
def test_fifty_seconds_of_each_are_needed(make_record: MakeRecord, rough: int, smooth: int) -> None:
    enough = make_record([], windows=[*seconds(11.5, ROUGH, 60), *seconds(10.0, SMOOTH, 60)])
    few = make_record([], windows=[*seconds(11.5, ROUGH, rough), *seconds(10.0, SMOOTH, smooth)])
    what = f"{rough} s on rough ground (over 3 mm RMS) and {smooth} s on smooth in the"
    for part in Part:
        records = {other: [few if other is part else enough] for other in Part}
        lack = f"{what} {part} episodes; 50 s of each are needed"
        told = study_ground(records, SIGNALS[0]).verdict.lack
        assert told == (None if min(rough, smooth) == 50 else lack)


@pytest.mark.parametrize(
    ("changed", "kept"),
    [
        ({"contact": 1.0}, False),
        ({"rocks": 0.01}, False),
        ({"speed": 0.049}, False),
        ({"speed": 0.05}, True),
    ],
)
def test_what_the_height_map_does_not_explain_is_left_out(
    make_record: MakeRecord, changed: dict[str, float], *, kept: bool
) -> None:
    windows = [*seconds(11.0, ROUGH, 6), *seconds(40.0, SMOOTH, 1, **changed), *seconds(11.0, ROUGH, 6)]
    record = make_record([], windows=windows)
    assert len(peak_acceleration(record).signal) == (13 if kept else 12)
    speeds = np.array([0.1, 0.2, 0.3, 0.4])  # one belongs to the bin that it begins
    assert ImuEvents(speeds, speeds > 0, speeds).within(0.2, 0.4).speed.tolist() == [0.2, 0.3]
    # Five seconds that have a second which is left out are left out.
    assert len(current_smoothness(record).signal) == (9 if kept else 4)


def test_current_smoothness_is_the_mean_of_five_seconds(make_record: MakeRecord) -> None:
    windows = [
        *seconds(10.0, SMOOTH, 4, speed=0.2),
        *seconds(20.0, 4 * ROUGH, 1, speed=0.7),
        *seconds(15.0, SMOOTH, 1, speed=0.2),
    ]
    events = current_smoothness(make_record([], windows=windows))
    assert events.signal == pytest.approx([12.0, 13.0])
    assert events.speed == pytest.approx([0.3, 0.3])
    assert events.rough.tolist() == [True, True]  # by the mean, 5.6 mm
    assert len(current_smoothness(make_record([], windows=windows[:5])).signal) == 1
    limits = [*seconds(11.0, 0.003, 1, speed=0.3), *seconds(11.0, 0.0031, 1, speed=0.4)]
    peaks = peak_acceleration(make_record([], windows=limits))  # rough above 3 mm
    assert (peaks.rough.tolist(), peaks.speed.tolist()) == ([False, True], pytest.approx([0.3, 0.4]))
    none = current_smoothness(make_record([], windows=windows[:4]))
    assert none.signal.size == none.rough.size == none.speed.size == 0
