"""Drawings and curves of the tuning report, against what can be worked out by hand."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh

from harness.page.figure import Plot
from harness.robots import ROVERS, RoverSpec, find_rover
from harness.tune.page.drawing import drawings
from harness.tune.page.outline import ABOVE, SIDE, shares, silent_strips, silhouette
from harness.tune.page.sample_figures import MOST_POINTS, has_both_classes, precision_recall, roc
from tests.harness.frames.made_rover import made_rover
from tests.support.rovers import LEO

if TYPE_CHECKING:
    from tests.harness.tune.conftest import Sweep

SQUARE = LEO.but(footprint=(-1.0, 1.0, -1.0, 1.0), lidar_x=0.0)


@pytest.mark.parametrize(
    ("threshold", "covering"),
    [
        (1.5, 1.0),  # beyond the corners
        (math.sqrt(1.25), 0.5),  # half of each side
        (0.9, 0.0),
    ],
)
def test_a_threshold_covers_the_part_of_the_outline_within_its_circle(
    threshold: float, covering: float
) -> None:
    near, covered, far = shares(SQUARE, (0.15, threshold))
    assert covered == pytest.approx(covering, abs=2e-3)
    assert far == pytest.approx(1.0 - covering, abs=2e-3)
    assert near == 0.0
    near, covered, _ = shares(SQUARE, (math.sqrt(1.25), 1.5))  # nearer than range_min is no alarm
    assert (near, covered) == pytest.approx((0.5, 0.5), abs=2e-3)


def test_strips_run_beside_the_corners_that_are_too_far_and_the_middles_that_are_too_near() -> None:
    far = list(silent_strips(SQUARE, (0.0, math.sqrt(1.25)), 0.1, 0.2))
    assert len(far) == 8  # both ends of each side
    for strip in far:
        inner, outer = np.abs(strip).max(axis=1)[:2], np.abs(strip).max(axis=1)[2:]
        assert inner == pytest.approx([1.1, 1.1])
        assert outer == pytest.approx([1.3, 1.3])
        along = np.sort(np.abs(strip).min(axis=1))
        assert along == pytest.approx([0.5, 0.5, 1.0, 1.0], abs=2e-3)
    near = list(silent_strips(SQUARE, (math.sqrt(1.25), 1.5), 0.0, 0.2))
    assert len(near) == 4
    assert all(np.ptp(strip, axis=0).max() == pytest.approx(1.0, abs=4e-3) for strip in near)
    assert list(silent_strips(SQUARE, (0.0, 1.5), 0.0, 0.2)) == []


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_a_silhouette_fills_the_footprint_and_reaches_up_to_the_lidar(rover: RoverSpec) -> None:
    above, side = (np.concatenate(silhouette(rover, axes)) for axes in (ABOVE, SIDE))
    x_min, x_max, y_min, y_max = rover.footprint
    assert above.min(axis=0) == pytest.approx([x_min, y_min], abs=0.01)
    assert above.max(axis=0) == pytest.approx([x_max, y_max], abs=0.01)
    assert side[:, 1].min() == pytest.approx(0.0, abs=0.01)
    assert rover.lidar_height < side[:, 1].max() < rover.lidar_height + 0.03


def test_a_silhouette_has_meshes_as_their_boxes_and_balls_as_balls(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((0.2, 0.4, 0.6)).export(tmp_path / "meshes" / "block.stl")
    seen = 'contype="0" conaffinity="0" mass="0"'
    body = f'<geom type="mesh" mesh="b" {seen}/><geom type="sphere" size="0.5" pos="5 0 0" {seen}/>'
    rover = made_rover(tmp_path, body, '<mesh name="b" file="block.stl"/>')
    block, ball = silhouette(rover, SIDE)
    assert np.ptp(block, axis=0) == pytest.approx([0.2, 0.6])
    assert np.ptp(ball, axis=0) == pytest.approx([1.0, 1.0])


@pytest.fixture
def pictures(small_sweep: "Sweep") -> dict[str, tuple[Plot, Plot]]:
    """Of both rovers, by name; the Leo's threshold is tuned."""
    studies = small_sweep[0]
    drawn = drawings([(one.name, find_rover(one.robot), one.collision) for one in studies])
    return {study.name: pair for study, pair in zip(studies, drawn, strict=True)}


def traces(plot: Plot) -> dict[str, np.ndarray]:
    """The points of each trace, shape (n, 2), by the start of its name."""
    return {
        trace["name"].split(":")[0]: np.array([trace["x"], trace["y"]], np.float64).T
        for trace in plot.figure["data"]
    }


def test_thresholds_are_circles_about_the_lidar_and_the_clearance_surrounds_the_outline(
    pictures: dict[str, tuple[Plot, Plot]], small_sweep: "Sweep"
) -> None:
    study, drawn = small_sweep[0][0].collision, traces(pictures["leo"][0])
    assert study.verdict.tuned is not None
    tuned = study.verdict.tuned.value
    lidar = (LEO.lidar_x, LEO.lidar_y)
    rings = {
        "range_min 0.15 m": 0.15,
        "default collision_threshold 0.2 m": 0.2,
        f"tuned collision_threshold {tuned:g} m": tuned,
    }
    for name, radius in rings.items():
        assert np.hypot(*(drawn[name] - lidar).T) == pytest.approx(radius, abs=1e-3), name
    (clearance,) = [name for name in drawn if name.startswith("best footprint clearance")]
    away = float(clearance.split()[-2])
    x_min, x_max, y_min, y_max = LEO.footprint
    nearest = drawn[clearance].clip((x_min, y_min), (x_max, y_max))
    assert np.hypot(*(drawn[clearance] - nearest).T) == pytest.approx(away, abs=1e-3)
    assert drawn["footprint, 0.43 \N{MULTIPLICATION SIGN} 0.43 m"].max(axis=0) == pytest.approx(
        [x_max, y_max], abs=1e-3
    )


def test_strips_without_an_alarm_stand_beside_the_outline_one_behind_the_other(
    pictures: dict[str, tuple[Plot, Plot]],
) -> None:
    plot = pictures["leo"][0]
    strips = [trace for trace in plot.figure["data"] if "fillpattern" in trace]
    assert [(key.swatch, key.name.split(":")[0]) for key in plot.legend][1:3] == [
        ("hatch", "no alarm below 0.2 m"),
        ("cross", strips[1]["name"].split(":")[0]),
    ]
    x_min, x_max, y_min, y_max = LEO.footprint
    for number, strip in enumerate(strips):
        points = np.array([strip["x"], strip["y"]], np.float64).T
        points = points[~np.isnan(points[:, 0])]
        outside = np.abs(points - points.clip((x_min, y_min), (x_max, y_max))).max(axis=1)
        assert set(np.round(outside / 0.035).tolist()) == {number, number + 1}


def test_all_rovers_are_drawn_to_one_scale_with_what_their_lidar_sees_of_each_hazard(
    pictures: dict[str, tuple[Plot, Plot]],
) -> None:
    seen = {}
    for name, pair in pictures.items():
        for mine, first in zip(pair, pictures["leo"], strict=True):
            layout = mine.figure["layout"]
            assert layout["yaxis"]["scaleanchor"] == "x"
            for axis in ("xaxis", "yaxis"):
                assert layout[axis]["range"] == first.figure["layout"][axis]["range"]
        seen[name] = [label.split("<br>")[-1] for label in layout["xaxis"]["ticktext"]]
        assert f"{find_rover(name).lidar_height:.2f} m up" in pair[1].summary
    assert seen["leo"] == ["not seen", "some seen", "seen"]  # cube, boulder, post
    assert seen["rover_zero4wd"] == ["seen", "seen", "seen"]


def test_what_stands_in_front_of_a_rover_is_as_high_as_its_label_says(
    pictures: dict[str, tuple[Plot, Plot]],
) -> None:
    drawn = traces(pictures["leo"][1])
    middles = pictures["leo"][1].figure["layout"]["xaxis"]["tickvals"]
    for name, heights in (("least", (0.5, 0.5)), ("largest", (0.5, 0.85))):
        points = drawn[f"hazards of the {name} height"]
        for middle, height in zip(middles, heights, strict=False):
            near = points[np.abs(points[:, 0] - middle) < 0.46]
            assert near[:, 1].max() == pytest.approx(height, abs=1e-3)


def test_curves_of_many_values_are_thinned_and_keep_their_ends_and_their_area() -> None:
    rng = np.random.default_rng(0)
    truth = rng.random(20_000) < 0.1
    score = rng.normal(truth * 2.0)
    curve = roc(score, truth)
    assert len(curve.x) <= MOST_POINTS + 1
    assert (curve.x[0], curve.y[0], curve.x[-1], curve.y[-1]) == (0.0, 0.0, 1.0, 1.0)
    assert np.trapezoid(curve.y, curve.x) == pytest.approx(curve.area, abs=0.002)
    assert curve.area == pytest.approx(0.921, abs=0.01)  # Phi(2 / sqrt 2)
    assert not has_both_classes(np.ones(3, dtype=bool))
    assert not has_both_classes(np.zeros(0, dtype=bool))
    along = precision_recall(score, truth)
    assert (along.x[0] > 0.0, along.x[-1], along.y[-1]) == (True, 1.0, pytest.approx(truth.mean()))
