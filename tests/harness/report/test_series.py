import math

import pytest

from harness.page.figure import keys
from harness.report.log import Event, Log
from harness.report.recorder import Stretch
from harness.report.series import series_figure, thinned, varies
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, Thresholds

_NOTHING: tuple[Thresholds, list[Stretch], list[Event]] = (DEFAULT_THRESHOLDS, [], [])


def test_the_truth_is_drawn_beside_distance_and_velocity() -> None:
    track = [Stretch(1.0, (0.0,) * 3, 0.5), Stretch(3.0, (0.0,) * 3, 1.5), Stretch(3.5, (0.0,) * 3, 1.6)]
    columns = ("Distance Traveled", "Current Velocity")
    log = Log([1.0, 2.0, 3.0], {name: [0.1, 0.2, 0.3] for name in columns})
    distance = series_figure("Distance Traveled", log, DEFAULT_THRESHOLDS, track, [], gravity=9.8)
    assert [(t["name"], t["x"], t["y"]) for t in distance["data"]] == [
        ("log", [1.0, 2.0, 3.0], [0.1, 0.2, 0.3]),
        ("truth", [1.0, 3.0, 3.5], [0.5, 1.5, 1.6]),
    ]
    velocity = series_figure("Current Velocity", log, DEFAULT_THRESHOLDS, track, [], gravity=9.8)
    assert (velocity["data"][1]["x"], velocity["data"][1]["y"]) == ([3.0, 3.5], [0.5, 0.2])
    assert velocity["layout"]["xaxis"]["range"] == [0.0, 3.5]
    assert [key.dash for key in keys(velocity)] == ["", "2 2"]


NAN, INF = math.nan, math.inf


@pytest.mark.parametrize(
    ("name", "values", "track", "shown"),
    [
        ("VORT [m/s]", [NAN, NAN, NAN], [], False),
        ("Slip", [0.5, 0.5, 0.5], [], False),
        ("Slip", [0.5, NAN, 0.5], [], False),
        ("Slip", [0.5, 0.5, 0.4], [], True),
        ("Obstacle Clearance", [INF, INF, INF], [], False),
        ("Obstacle Clearance", [INF, 3.0, 3.0], [], True),
        ("Distance Traveled", [0.0, 0.0, 0.0], [0.0, 1.0], True),  # and the truth moves
        ("Distance Traveled", [0.0, 0.0, 0.0], [0.0, 0.0], False),
    ],
)
def test_a_column_is_worth_a_plot_if_anything_changes_in_it(
    name: str, values: list[float], track: list[float], *, shown: bool
) -> None:
    driven = [Stretch(time + 1.0, (0.0,) * 3, length) for time, length in enumerate(track)]
    log = Log([1.0, 2.0, 3.0], {name: values})
    figure = series_figure(name, log, DEFAULT_THRESHOLDS, driven, [], gravity=9.8)
    assert varies(figure, values) is shown


@pytest.mark.parametrize(
    ("values", "mode"),
    [
        ([0.1], "lines+markers"),
        ([NAN, 0.1, NAN, 0.2, 0.3], "lines+markers"),
        ([0.1, 0.2, NAN, 0.2, 0.3], "lines"),
        ([0.1, 0.2, NAN, 0.2], "lines+markers"),
    ],
)
def test_a_value_between_gaps_is_seen(values: list[float], mode: str) -> None:
    log = Log([float(n) for n in range(len(values))], {"Slip": values})
    (drawn,) = series_figure("Slip", log, *_NOTHING, gravity=9.8)["data"]
    assert drawn["mode"] == mode


def test_a_long_series_is_thinned_without_losing_peaks_or_gaps() -> None:
    values = [0.0] * 100_000
    values[123], values[45_678], values[77_777] = 7.0, -9.0, math.inf
    times, kept = thinned([float(i) for i in range(100_000)], values, most=1000)
    assert len(kept) <= 1000
    assert {7.0, -9.0, math.inf} <= set(kept)
    assert times == sorted(times)
    assert thinned([0.0, 1.0, 2.0, 3.0], [0.0, 7.0, math.inf, 1.0], most=2)[1] == [7.0, math.inf]
