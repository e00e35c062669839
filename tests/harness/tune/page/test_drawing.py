"""Drawings and curves of the tuning report, against what can be worked out by hand."""

import math
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import trimesh

from harness.robots import ROVERS, RoverSpec
from harness.tune.page.drawing import HAZARDS, Distances, drawings
from harness.tune.page.outline import ABOVE, SIDE, shares, silhouette, untold_strips
from harness.tune.page.scan_figures import MOST_POINTS, has_both_classes, precision_recall, roc
from tests.harness.frames.made_rover import made_rover
from tests.support.rovers import LEO, ROVER_ZERO4WD

SQUARE = LEO.but(footprint=(-1.0, 1.0, -1.0, 1.0), lidar_x=0.0)
AROUND = Distances(range_min=0.15, default=0.2, tuned=0.44, clearance=0.05)


@pytest.mark.parametrize(
    ("threshold", "told"),
    [
        (1.5, 1.0),  # beyond the corners
        (math.sqrt(1.25), 0.5),  # half of each side
        (0.9, 0.0),
    ],
)
def test_a_threshold_covers_the_part_of_the_outline_within_its_circle(
    threshold: float, told: float
) -> None:
    near, covered, far = shares(SQUARE, (0.15, threshold))
    assert covered == pytest.approx(told, abs=2e-3)
    assert far == pytest.approx(1.0 - told, abs=2e-3)
    assert near == 0.0


def test_what_is_nearer_than_range_min_is_not_told() -> None:
    near, covered, _ = shares(SQUARE, (math.sqrt(1.25), 1.5))
    assert near == pytest.approx(0.5, abs=2e-3)
    assert covered == pytest.approx(0.5, abs=2e-3)
    assert shares(SQUARE, (math.sqrt(1.25), 1.0))[1] == pytest.approx(0.0)


def test_strips_run_beside_the_corners_that_are_too_far_and_the_middles_that_are_too_near() -> None:
    far = list(untold_strips(SQUARE, (0.0, math.sqrt(1.25)), 0.1, 0.2))
    assert len(far) == 8  # both ends of each side
    for strip in far:
        inner, outer = np.abs(strip).max(axis=1)[:2], np.abs(strip).max(axis=1)[2:]
        assert inner == pytest.approx([1.1, 1.1])
        assert outer == pytest.approx([1.3, 1.3])
        along = np.sort(np.abs(strip).min(axis=1))
        assert along == pytest.approx([0.5, 0.5, 1.0, 1.0], abs=2e-3)
    near = list(untold_strips(SQUARE, (math.sqrt(1.25), 1.5), 0.0, 0.2))
    assert len(near) == 4
    assert all(np.ptp(strip, axis=0).max() == pytest.approx(1.0, abs=4e-3) for strip in near)
    assert list(untold_strips(SQUARE, (0.0, 1.5), 0.0, 0.2)) == []


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


def test_what_a_lidar_sees_of_a_hazard_depends_on_its_height() -> None:
    seen = {
        rover.name: [hazard.seen(rover.lidar_height) for hazard in HAZARDS]
        for rover in (LEO, ROVER_ZERO4WD)
    }
    assert seen["leo"] == ["not seen", "some seen", "seen"]  # cube, boulder, post
    assert seen["rover_zero4wd"] == ["seen", "seen", "seen"]


def test_drawings_are_well_formed_and_to_one_scale() -> None:
    rovers = (LEO, ROVER_ZERO4WD)
    pictures = drawings([(rover, AROUND) for rover in rovers])
    assert pictures == drawings([(rover, AROUND) for rover in rovers])
    first, second = (ET.fromstring(_named(picture)) for picture in pictures)  # noqa: S314 - ours
    assert first.attrib["viewBox"] == second.attrib["viewBox"]
    assert "leo to scale" in first.attrib["aria-label"]
    assert "cube of 0.5 m: not seen" in first.attrib["aria-label"]
    rings = [_width(path) for path in first.iter("path") if "C" in path.attrib["d"]]
    ratio = AROUND.tuned / AROUND.default  # type: ignore[operator]  # given
    assert any(one / other == pytest.approx(ratio, rel=1e-3) for one in rings for other in rings)


def test_drawings_take_their_colours_from_the_page_and_share_no_names() -> None:
    pictures = drawings([(rover, AROUND) for rover in (LEO, ROVER_ZERO4WD)])
    names = [name for picture in pictures for name in re.findall(r' id="([^"]+)"', picture)]
    assert len(names) == len(set(names))
    for picture in pictures:
        assert not re.search(r"https?:|<style|#[0-9a-f]{6}", picture)
        assert "fill: var(--ink)" in picture
        assert set(re.findall(r"#([^)\"]+)", picture)) <= set(names)


def _named(picture: str) -> str:
    """A picture as XML, where the prefix of links has a name."""
    return str(picture).replace("<svg ", '<svg xmlns:xlink="links" ', 1)


def _width(path: ET.Element) -> float:
    x = [float(number) for number in re.findall(r"(-?[\d.]+) -?[\d.]+", path.attrib["d"])]
    return max(x) - min(x)


def test_curves_of_many_values_are_thinned_and_keep_their_ends_and_their_area() -> None:
    rng = np.random.default_rng(0)
    truth = rng.random(20_000) < 0.1
    score = rng.normal(truth * 2.0)
    curve = roc(score, truth)
    assert len(curve.x) <= MOST_POINTS + 1
    assert (curve.x[0], curve.y[0], curve.x[-1], curve.y[-1]) == (0.0, 0.0, 1.0, 1.0)
    assert np.trapezoid(curve.y, curve.x) == pytest.approx(curve.area, abs=0.002)
    assert curve.area == pytest.approx(0.921, abs=0.01)  # Phi(2 / sqrt 2)
    along = precision_recall(score, truth)
    assert (along.x[0] > 0.0, along.x[-1], along.y[-1]) == (True, 1.0, pytest.approx(truth.mean()))


def test_a_curve_needs_both_classes() -> None:
    assert not has_both_classes(np.ones(3, dtype=bool))
    assert not has_both_classes(np.zeros(0, dtype=bool))
    assert has_both_classes(np.array([True, False]))
