import math

from harness.page.figure import keys
from harness.report.log import Event, Log
from harness.report.recorder import Stretch
from harness.report.series import series_figure, thinned
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, Thresholds
from tests.harness.report.stretches import stretches

_NOTHING: tuple[Thresholds, list[Stretch], list[Event]] = (DEFAULT_THRESHOLDS, [], [])


def test_every_threshold_of_a_column_is_drawn_with_its_value_and_unit() -> None:
    log = Log([1.0, 2.0], {"Obstacle Clearance": [1.0, math.inf]})
    figure = series_figure(
        "Obstacle Clearance", log, Thresholds(collision_threshold=0.3), [], [], gravity=9.8
    )
    assert {key.name for key in keys(figure)} == {
        "log",
        "collision_threshold = 0.3 m",
        "min_safe_clearance = 0.5 m",
    }
    assert [shape["y0"] for shape in figure["layout"]["shapes"]] == [0.3, 0.5]
    assert [key.dash for key in keys(figure)] == ["", "6 4", "8 3 2 3"]
    assert figure["layout"]["xaxis"]["range"] == [0.0, 2.0]
    assert figure["data"][0]["y"] == [1.0, None]


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


def test_the_band_of_all_imu_samples_lies_behind_the_log() -> None:
    name = "IMU Acceleration Magnitude"
    track = stretches({"lowest_acceleration": 9.0, "highest_acceleration": 11.0}, {})
    figure = series_figure(name, Log([1.0], {name: [9.8]}), DEFAULT_THRESHOLDS, track, [], gravity=9.8)
    low, high, log = figure["data"]
    assert (low["y"], high["y"], log["y"]) == ([9.0, None], [11.0, None], [9.8])
    assert high["fill"] == "tonexty"
    assert [key.name for key in keys(figure)][:2] == ["all samples, as simulated", "log"]
    assert [shape["y0"] for shape in figure["layout"]["shapes"]] == [
        DEFAULT_THRESHOLDS.rough_terrain_threshold,
        9.8,
    ]
    assert "rangemode" not in figure["layout"]["yaxis"]
    assert log["mode"] == "lines+markers", "a single point has no line"


def test_contacts_are_bands_and_flags_are_steps() -> None:
    name, touched = "Is Rough Terrain", [Event(1.0, 2.5, (0.0, 0.0, 0.0))]
    log = Log([1.0, 2.0, 3.0], {name: [0.0, 1.0, 0.0]})
    figure = series_figure(name, log, DEFAULT_THRESHOLDS, [], touched, gravity=9.8)
    (band,) = figure["layout"]["shapes"]
    assert (band["x0"], band["x1"], band["y0"], band["y1"]) == (1.0, 2.5, 0.0, 1.0)
    assert figure["data"][0]["line"]["shape"] == "hv"
    assert figure["layout"]["yaxis"]["range"] == [-0.1, 1.1]
    counted = series_figure(
        "Total Collisions", Log([1.0], {"Total Collisions": [0.0]}), *_NOTHING, gravity=9.8
    )
    assert counted["layout"]["yaxis"]["rangemode"] == "tozero"
    assert counted["layout"]["yaxis"]["autorangeoptions"] == {"include": [0, 4]}


def test_an_unknown_column_is_drawn_with_the_unit_in_its_name() -> None:
    log = Log([1.0], {"Wheel Heat [K]": [300.0]})
    figure = series_figure("Wheel Heat [K]", log, DEFAULT_THRESHOLDS, [], [], gravity=9.8)
    assert figure["layout"]["yaxis"]["title"] == {"text": "[K]"}


def test_a_gap_does_not_hide_the_peak_beside_it() -> None:
    assert thinned([0.0, 1.0, 2.0, 3.0], [0.0, 7.0, math.inf, 1.0], most=2)[1] == [7.0, math.inf]


def test_a_long_series_is_thinned_without_losing_peaks_or_gaps() -> None:
    values = [0.0] * 100_000
    values[123], values[45_678], values[77_777] = 7.0, -9.0, math.inf
    times, kept = thinned([float(i) for i in range(100_000)], values, most=1000)
    assert len(kept) <= 1000
    assert {7.0, -9.0, math.inf} <= set(kept)
    assert times == sorted(times)
