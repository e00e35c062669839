"""Drawings and curves of the tuning report, against what can be worked out by hand."""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from harness.robots import ROVERS, RoverSpec
from harness.robots.model import SEEN_GROUP, read_model
from harness.tune.page.outline import ABOVE, SIDE, shares, silent_strips, silhouette
from tests.harness.robots.frames.made_rover import made_rover
from tests.support.rovers import LEO

SQUARE = LEO.but(footprint=(-1.0, 1.0, -1.0, 1.0), lidar_x=0.0)


@pytest.mark.parametrize(
    ("threshold", "covering"),
    [
        (1.5, 1.0),  # beyond the corners
        (math.sqrt(1.25), 0.5),  # half of each side
        (0.9, 0.0),
    ],
)
def test_a_threshold_covers_what_lies_within_its_circle(threshold: float, covering: float) -> None:
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


@pytest.mark.parametrize("axes", [ABOVE, SIDE])
def test_a_silhouette_is_as_large_as_each_kind_of_geom(axes: tuple[int, int], tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((0.2, 0.4, 0.6)).export(tmp_path / "meshes" / "block.stl")
    kinds = {"sphere": "0.5", "box": "0.1 0.2 0.3", "capsule": "0.1 0.2", "cylinder": "0.2 0.1"}
    kinds |= {"ellipsoid": "0.1 0.2 0.4"}
    geoms = [f'type="{kind}" size="{size}"' for kind, size in kinds.items()] + ['type="mesh" mesh="b"']
    body = "".join(f'<geom {one} contype="0" conaffinity="0" mass="0"/>' for one in geoms)
    rover = made_rover(tmp_path, body, '<mesh name="b" file="block.stl"/>')
    model = read_model(rover).compile()
    boxes = 2 * model.geom_aabb[model.geom_group == SEEN_GROUP, 3:][:, axes]
    sizes = [np.ptp(outline, axis=0) for outline in silhouette(rover, axes)]
    assert np.array(sizes) == pytest.approx(boxes, rel=0.02)
