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
    log = Log(
        [1.0, 2.0, 3.0], {name: [0.1, 0.2, 0.3] for name in ("Distance Traveled", "Current Velocity")}
    )
    log.columns["Total Collisions"] = [0.0, 1.0, 2.0]
    distance = series_figure("Distance Traveled", log, DEFAULT_THRESHOLDS, track, [], gravity=9.8)
    assert [(t["name"], t["x"], t["y"]) for t in distance["data"]] == [
        ("log", [1.0, 2.0, 3.0], [0.1, 0.2, 0.3]),
        ("truth", [1.0, 3.0, 3.5], [0.5, 1.5, 1.6]),
    ]
    velocity = series_figure("Current Velocity", log, DEFAULT_THRESHOLDS, track, [], gravity=9.8)
    assert (velocity["data"][1]["x"], velocity["data"][1]["y"]) == ([3.0, 3.5], [0.5, 0.2])
    assert (
        len(series_figure("Total Collisions", log, DEFAULT_THRESHOLDS, track, [], gravity=9.8)["data"])
        == 1
    )
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


@pytest.mark.parametrize(
    ("name", "from_zero"),
    [
        ("Current Smoothness", False),
        ("IMU Acceleration Magnitude", False),
        ("Vertical Roughness", False),
        ("Smoothness Metric", True),
        ("Obstacle Clearance", True),
    ],
)
def test_where_gravity_is_in_the_values_its_level_is_drawn_and_the_axis_leaves_zero_out(
    name: str, *, from_zero: bool
) -> None:
    figure = series_figure(name, Log([1.0, 2.0], {name: [9.5, 9.9]}), *_NOTHING, gravity=3.71)
    levels = {shape["name"]: shape["y0"] for shape in figure["layout"]["shapes"]}
    assert ("rangemode" in figure["layout"]["yaxis"]) is from_zero
    assert (levels.get("g = 3.71 m/s²") == 3.71) is not from_zero


def test_a_gap_does_not_hide_the_peak_beside_it() -> None:
    assert thinned([0.0, 1.0, 2.0, 3.0], [0.0, 7.0, math.inf, 1.0], most=2)[1] == [7.0, math.inf]


def test_a_long_series_is_thinned_without_losing_peaks_or_gaps() -> None:
    values = [0.0] * 100_000
    values[123], values[45_678], values[77_777] = 7.0, -9.0, math.inf
    times, kept = thinned([float(i) for i in range(100_000)], values, most=1000)
    assert len(kept) <= 1000
    assert {7.0, -9.0, math.inf} <= set(kept)
    assert times == sorted(times)
