import base64
import io
import math
from dataclasses import replace

import numpy as np
import pytest

from harness.page.figure import keys
from harness.report.hillshade import map_layout, shade
from harness.report.log import Event, Log, collisions, contacts
from harness.report.recorder import Stretch
from harness.report.series import series_figure, thinned
from harness.report.terrain_map import map_figure, roughness
from harness.robots import LEO
from harness.samples import LaserScan, PlacedScan, Pose
from harness.sensors.scan_points import scan_points
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, orientation, outline
from harness.world.world import build_world
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, Thresholds

NO_POINTS = np.empty((0, 2))
_NOTHING: tuple[Thresholds, list[Stretch], list[Event]] = (DEFAULT_THRESHOLDS, [], [])


def stretches(*changes: dict[str, float]) -> list[Stretch]:
    """A drive along x at 1 m/s, a stretch a second."""
    return [
        Stretch(float(i + 1), (float(i + 1), 0.0, 0.0), float(i + 1), **values)
        for i, values in enumerate(changes)
    ]


def test_slopes_towards_the_north_west_are_lit_and_others_lie_in_the_shade() -> None:
    x, y = np.meshgrid(np.linspace(-2.0, 2.0, 41), np.linspace(-2.0, 2.0, 41))
    cone = shade(Heightfield(heights=-np.hypot(x, y), cell=0.1)).pixels
    north_west, south_east = cone[10, 10], cone[30, 30]
    assert int(north_west) > int(south_east) + 100


@pytest.mark.parametrize(
    ("slope_x", "slope_y", "light"),
    [
        # Lambert: the cosine between the normal and the sun, in the north-west 45 degrees up.
        (0.0, 0.0, math.sqrt(0.5)),
        (0.7, 0.0, (math.sqrt(0.5) + 0.7 * 0.5) / math.hypot(1.0, 0.7)),
        (-0.7, 0.0, (math.sqrt(0.5) - 0.7 * 0.5) / math.hypot(1.0, 0.7)),
        (0.0, -0.7, (math.sqrt(0.5) + 0.7 * 0.5) / math.hypot(1.0, 0.7)),
        (0.35, -0.35, 1.0),
    ],
)
def test_a_plane_is_as_bright_as_the_cosine_between_its_normal_and_the_sun(
    slope_x: float, slope_y: float, light: float
) -> None:
    """The slope that shows is that of 35 degrees, whatever the plane's own."""
    axis = np.arange(21) * 0.1
    hillshade = shade(Heightfield(slope_x * axis[None, :] + slope_y * axis[:, None], cell=0.1))
    exaggeration = math.tan(math.radians(35.0)) / (math.hypot(slope_x, slope_y) or 1e-9)
    assert hillshade.exaggeration == pytest.approx(min(exaggeration, 8.0))
    x, y = (hillshade.exaggeration * slope for slope in (slope_x, slope_y))
    normal = np.array([-x, -y, 1.0]) / math.sqrt(1.0 + x * x + y * y)
    sun = np.array([-0.5, 0.5, math.sqrt(0.5)])
    assert hillshade.pixels == pytest.approx(np.full((21, 21), 70 + 180 * (normal @ sun)), abs=0.51)
    if hillshade.exaggeration == pytest.approx(1.0, abs=1e-3):
        assert normal @ sun == pytest.approx(light, abs=1e-3)


def test_only_the_steepest_twentieth_is_exaggerated_less() -> None:
    heights = np.tile(np.maximum(np.arange(41) - 36.0, 0.0) * 0.1, (41, 1))  # a tenth of it slopes
    assert shade(Heightfield(heights, cell=0.1)).exaggeration == pytest.approx(0.7, abs=1e-3)


def test_north_is_up_in_the_hillshade() -> None:
    heights = np.zeros((21, 21))
    heights[18, 5] = 1.0  # north, as y is large
    pixels = shade(Heightfield(heights, cell=0.1)).pixels.astype(int)
    rows, columns = np.nonzero(pixels != pixels[20, 20])
    assert (rows.mean(), columns.mean()) == pytest.approx((2.0, 5.0))


def test_hillshade_is_a_png_whose_pixels_lie_around_the_vertices() -> None:
    hillshade = shade(build_world("rocky", seed=0).ground)
    assert (hillshade.west, hillshade.north) == pytest.approx((-20.05, 20.05))
    kind, data = hillshade.data_uri().split(",")
    assert kind == "data:image/png;base64"
    image = pytest.importorskip("matplotlib.image", reason="reads the picture back")
    read = image.imread(io.BytesIO(base64.b64decode(data)))
    assert np.array_equal((read * 255).round().astype(np.uint8), hillshade.pixels)


def test_a_large_terrain_becomes_a_picture_of_bounded_size() -> None:
    hillshade = shade(Heightfield(heights=np.zeros((2501, 2501)), cell=0.1))
    assert len(hillshade.pixels) == 501
    assert hillshade.side == pytest.approx(501 * 0.5)


@pytest.mark.parametrize(
    ("shape", "half_size", "area"),
    [
        ("box", (2.0, 1.0, 0.5), 8.0),
        ("ellipsoid", (2.0, 1.0, 0.5), math.tau),
        ("cylinder", (1.0, 3.0), math.pi),
    ],
)
def test_outline_of_a_turned_obstacle_has_its_area(
    shape: str, half_size: tuple[float, ...], area: float
) -> None:
    obstacle = Obstacle(
        kind=ObstacleKind.HAZARD,
        shape=shape,  # type: ignore[arg-type]  # one of the literals above
        half_size=half_size,
        position=(5.0, -3.0, 0.0),
        quaternion=orientation(0.7),
    )
    points = outline(obstacle)
    x, y = points.T
    assert 0.5 * abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))) == pytest.approx(
        area, rel=0.05
    )
    assert points.max(axis=0) + points.min(axis=0) == pytest.approx([10.0, -6.0], abs=0.05)


def test_beams_of_a_scan_end_where_the_lidar_saw_something() -> None:
    # The lidar looks backwards: its middle beams go to where the rover comes from.
    ranges = np.array([np.inf, 2.0, np.inf], dtype=np.float32)
    north = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))
    placed = PlacedScan(LaserScan(0, ranges), Pose(0, (1.0, 1.0, 0.0), north))
    assert scan_points(placed, LEO) == pytest.approx(np.array([[1.0, 1.0 + 0.174 - 2.0]]), abs=1e-3)


def test_contacts_with_short_gaps_are_one_event() -> None:
    touching = {"contact_s": 0.1}
    found = contacts(stretches({}, touching, touching, {}, touching))
    assert [(event.start_s, event.end_s) for event in found] == [(1.0, 3.0), (4.0, 5.0)]
    assert found[0].position == (2.0, 0.0, 0.0)


def test_logged_collisions_are_placed_where_a_scan_was_nearest() -> None:
    track = stretches({"nearest_range": 0.4}, {"nearest_range": 0.15}, {"nearest_range": 0.3}, {})
    log = Log([1.0, 3.0, 4.0], {"Total Collisions": [0.0, 2.0, 2.0]})
    (event,) = collisions(log, track)
    assert (event.start_s, event.end_s) == (1.0, 3.0)
    assert event.position == (2.0, 0.0, 0.0)


def test_a_collision_between_two_stretches_is_placed_in_the_one_around_it() -> None:
    track = stretches({}, {}, {})
    (event,) = collisions(Log([1.2, 1.4, 2.9], {"Total Collisions": [0.0, 1.0, 1.0]}), track)
    assert (event.start_s, event.end_s, event.position) == (1.2, 1.4, (2.0, 0.0, 0.0))
    assert event.label == "1.2 to 1.4 s"
    before = stretches({"nearest_range": 0.1}, {"nearest_range": 0.2}, {"nearest_range": 0.1})
    (event,) = collisions(Log([1.0, 2.0], {"Total Collisions": [0.0, 1.0]}), before)
    assert event.position == (2.0, 0.0, 0.0), "a stretch that ends with the row before is not in it"
    rising = Log([1.0, 1.6, 2.5], {"Total Collisions": [1.0, 1.0, 2.0]})
    assert [(e.start_s, e.end_s) for e in collisions(rising, track)] == [(0.0, 1.0), (1.6, 2.5)]


def test_contacts_half_a_second_apart_are_one_event_and_farther_ones_two() -> None:
    track = [
        Stretch(time, (time, 0.0, 0.0), 0.0, contact_s=touched)
        for time, touched in ((0.5, 0.1), (1.0, 0.0), (1.5, 0.1), (2.1, 0.0), (2.5, 0.1))
    ]
    assert [(e.start_s, e.end_s) for e in contacts(track)] == [(0.0, 1.5), (2.1, 2.5)]


def test_a_log_without_the_counter_has_no_collisions() -> None:
    assert collisions(Log(), stretches({}, {})) == []


def test_roughness_counts_in_both_directions_and_holds_where_no_sample_is() -> None:
    quiet = {"lowest_acceleration": 9.8, "highest_acceleration": 9.8}
    dip = {"lowest_acceleration": 6.8, "highest_acceleration": 10.0}
    assert roughness(stretches(quiet, dip, {})) == pytest.approx([0.0, 3.0, 3.0])


def test_map_shows_the_path_and_everything_that_happened_on_it() -> None:
    world = build_world("rocky", seed=0)
    track = stretches({"contact_s": 0.1, "nearest_range": 0.1}, {}, {})
    log = Log([1.0], {"Total Collisions": [5.0]})
    figure = map_figure(
        world,
        shade(world.ground),
        track,
        collisions=collisions(log, track),
        contacts=contacts(track),
        scan=np.array([[1.0, 2.0]]),
    )
    assert {key.name for key in keys(figure)} == {
        "rock",
        "hazard",
        "last scan",
        "start",
        "end",
        "collision (metric)",
        "contact with a hazard (truth)",
    }
    (path,) = (trace for trace in figure["data"] if "customdata" in trace)
    assert sorted(path["x"]) == [1.0, 2.0, 3.0]


def test_map_of_a_run_that_never_moved_or_diverged_shows_the_terrain() -> None:
    world = build_world("flat", seed=0)
    lost = Stretch(1.0, (math.nan, 0.0, 0.0), 0.0)
    figure = map_figure(world, shade(world.ground), [lost], collisions=[], contacts=[], scan=NO_POINTS)
    assert figure["data"] == []
    assert figure["layout"]["xaxis"]["range"] == [-20.0, 20.0]


def test_every_threshold_of_a_column_is_drawn_with_its_value_and_unit() -> None:
    log = Log([1.0, 2.0], {"Obstacle Clearance": [1.0, math.inf]})
    figure = series_figure("Obstacle Clearance", log, Thresholds(collision_threshold=0.3), [], [])
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
    distance = series_figure("Distance Traveled", log, DEFAULT_THRESHOLDS, track, [])
    assert [(t["name"], t["x"], t["y"]) for t in distance["data"]] == [
        ("log", [1.0, 2.0, 3.0], [0.1, 0.2, 0.3]),
        ("truth", [1.0, 3.0, 3.5], [0.5, 1.5, 1.6]),
    ]
    velocity = series_figure("Current Velocity", log, DEFAULT_THRESHOLDS, track, [])
    assert (velocity["data"][1]["x"], velocity["data"][1]["y"]) == ([3.0, 3.5], [0.5, 0.2])
    assert len(series_figure("Total Collisions", log, DEFAULT_THRESHOLDS, track, [])["data"]) == 1
    assert velocity["layout"]["xaxis"]["range"] == [0.0, 3.5]
    assert [key.dash for key in keys(velocity)] == ["", "2 2"]


def test_the_band_of_all_imu_samples_lies_behind_the_log() -> None:
    name = "IMU Acceleration Magnitude"
    track = stretches({"lowest_acceleration": 9.0, "highest_acceleration": 11.0}, {})
    figure = series_figure(name, Log([1.0], {name: [9.8]}), DEFAULT_THRESHOLDS, track, [])
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
    figure = series_figure(name, log, DEFAULT_THRESHOLDS, [], touched)
    (band,) = figure["layout"]["shapes"]
    assert (band["x0"], band["x1"], band["y0"], band["y1"]) == (1.0, 2.5, 0.0, 1.0)
    assert figure["data"][0]["line"]["shape"] == "hv"
    assert figure["layout"]["yaxis"]["range"] == [-0.1, 1.1]
    counted = series_figure("Total Collisions", Log([1.0], {"Total Collisions": [0.0]}), *_NOTHING)
    assert counted["layout"]["yaxis"]["rangemode"] == "tozero"
    assert counted["layout"]["yaxis"]["autorangeoptions"] == {"include": [0, 4]}


@pytest.mark.parametrize(
    ("places", "x", "y"),
    [
        ([(0.0, 0.0), (2.0, 0.0)], [-3.0, 5.0], [-4.0, 4.0]),  # 8 m at least
        ([(0.0, 0.0), (10.0, 4.0)], [-2.0, 12.0], [-5.0, 9.0]),  # 2 m around the path
        ([(0.0, 0.0), (0.0, -19.0)], [-11.5, 11.5], [-20.0, 3.0]),  # not beyond the map
        ([(-19.0, -19.0), (19.0, 19.0)], [-20.0, 20.0], [-20.0, 20.0]),
    ],
)
def test_the_map_shows_a_square_around_the_path(
    places: list[tuple[float, float]], x: list[float], y: list[float]
) -> None:
    track = [Stretch(1.0, (*place, 0.0), 0.0) for place in places]
    hillshade = shade(Heightfield(np.zeros((5, 5)), cell=10.0))
    layout = map_layout(20.0, hillshade, track)
    assert (layout["xaxis"]["range"], layout["yaxis"]["range"]) == (x, y)
    (picture,) = layout["images"]
    assert [picture[name] for name in ("x", "y", "sizex", "sizey")] == [-25.0, 25.0, 50.0, 50.0]


def test_the_path_is_coloured_by_roughness_with_the_roughest_on_top() -> None:
    levels = (12.8, 9.8, 10.8)
    track = stretches(*({"lowest_acceleration": 9.8, "highest_acceleration": h} for h in levels))
    world = build_world("flat", seed=0)
    one = Event(1.0, 2.0, (7.0, 8.0, 0.0))
    other = replace(one, position=(5.0, 6.0, 0.0))
    figure = map_figure(
        world, shade(world.ground), track, collisions=[one], contacts=[other], scan=NO_POINTS
    )
    traces = {trace["name"]: trace for trace in figure["data"]}
    path = traces["path"]
    assert path["x"] == [2.0, 3.0, 1.0]
    assert path["marker"]["color"] == pytest.approx([0.0, 1.0, 3.0])
    assert path["customdata"][0] == [2.0, 0.0, 0.0]
    assert path["marker"]["cmax"] == 5.0
    assert (traces["start"]["x"], traces["end"]["x"]) == ([1.0], [3.0])
    hit, counted = traces["contact with a hazard (truth)"], traces["collision (metric)"]
    assert (hit["x"], hit["y"], counted["x"], counted["y"]) == ([5.0], [6.0], [7.0], [8.0])
    assert counted["text"] == ["1.0 to 2.0 s"]


def test_an_unknown_column_is_drawn_with_the_unit_in_its_name() -> None:
    log = Log([1.0], {"Wheel Heat [K]": [300.0]})
    figure = series_figure("Wheel Heat [K]", log, DEFAULT_THRESHOLDS, [], [])
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
