"""What is drawn on a page: the map on its hillshade, and columns over time."""

import base64
import io
import math

import numpy as np
import pytest
from PIL import Image

from harness.page.run.hillshade import map_layout, shade
from harness.page.run.log import Log
from harness.page.run.recorder import Stretch
from harness.page.run.series import series_figure, thinned, varies
from harness.page.run.terrain_map import map_figure
from harness.world.heightfield import Heightfield
from harness.world.world import build_world
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS


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


def test_the_hillshade_is_a_bounded_picture_with_north_up_around_the_vertices() -> None:
    heights = np.zeros((21, 21))
    heights[18, 5] = 1.0  # north, as y is large
    hillshade = shade(Heightfield(heights, cell=0.1))
    rows, columns = np.nonzero(hillshade.pixels != hillshade.pixels[20, 20])
    assert (rows.mean(), columns.mean()) == pytest.approx((2.0, 5.0))
    kind, data = hillshade.data_uri().split(",")
    assert kind == "data:image/png;base64"
    with Image.open(io.BytesIO(base64.b64decode(data))) as read:
        assert np.array_equal(np.asarray(read), hillshade.pixels)
    large = shade(Heightfield(heights=np.zeros((501, 2501)), cell=0.1))
    assert large.pixels.shape == (101, 501)
    assert (*large.size, large.west, large.north) == pytest.approx((250.5, 50.5, -125.25, 25.25))


@pytest.mark.parametrize(
    ("places", "x", "y"),
    [
        ([], [-30.0, 30.0], [-5.0, 5.0]),
        ([(0.0, 0.0), (2.0, 0.0)], [-3.0, 5.0], [-4.0, 4.0]),  # 8 m at least
        ([(0.0, 0.0), (5.0, 0.0)], [-2.0, 7.0], [-4.5, 4.5]),  # 2 m around the path
        ([(0.0, 0.0), (20.0, 4.0)], [-2.0, 22.0], [-5.0, 5.0]),  # not beyond the map
        ([(29.0, 4.0)], [22.0, 30.0], [-3.0, 5.0]),
    ],
)
def test_the_map_shows_a_square_around_the_path_and_no_more_than_there_is(
    places: list[tuple[float, float]], x: list[float], y: list[float]
) -> None:
    for middle in ((0.0, 0.0), (7.0, -3.0)):
        ground = Heightfield(np.zeros((11, 61)), 1.0, middle)
        moved = [Stretch(1.0, (p[0] + middle[0], p[1] + middle[1], 0.0), 0.0) for p in places]
        layout = map_layout(ground, shade(ground), moved)
        assert layout["xaxis"]["range"] == [end + middle[0] for end in x]
        assert layout["yaxis"]["range"] == [end + middle[1] for end in y]
        (picture,) = layout["images"]
        place = [picture[name] for name in ("x", "y", "sizex", "sizey")]
        assert place == [middle[0] - 30.5, middle[1] + 5.5, 61.0, 11.0]


def test_the_map_of_a_run_that_diverged_shows_the_terrain() -> None:
    world, lost = build_world("flat", seed=0), Stretch(1.0, (math.nan, 0.0, 0.0), 0.0)
    scan, relief = np.empty((0, 2)), shade(world.ground)
    figure = map_figure(world, relief, [lost], collisions=(), scan=scan, gravity=9.81)
    assert figure["data"] == []
    assert figure["layout"]["xaxis"]["range"] == [-20.0, 20.0]


NAN, INF = math.nan, math.inf


@pytest.mark.parametrize(
    ("name", "values", "track", "shown"),
    [
        ("VORT [m/s]", [NAN, NAN, NAN], [], False),
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
    (drawn,) = series_figure("Slip", log, DEFAULT_THRESHOLDS, [], [], gravity=9.8)["data"]
    assert drawn["mode"] == mode


def test_a_long_series_is_thinned_without_losing_peaks_or_gaps() -> None:
    values = [0.0] * 100_000
    values[123], values[45_678], values[77_777] = 7.0, -9.0, math.inf
    times, kept = thinned([float(i) for i in range(100_000)], values, most=1000)
    assert len(kept) <= 1000
    assert {7.0, -9.0, math.inf} <= set(kept)
    assert times == sorted(times)
    assert thinned([0.0, 1.0, 2.0, 3.0], [0.0, 7.0, math.inf, 1.0], most=2)[1] == [7.0, math.inf]
