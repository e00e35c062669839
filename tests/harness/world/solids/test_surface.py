"""Heightfields of meshes: cells, pits, small gaps, what is left over, and the error that is said."""

import re
from contextlib import nullcontext

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.base.mesh import Mesh
from harness.world.solids.surface import chosen_grid, surface_of
from tests.harness.world.solids.shapes import at, both, box, flat, sheet


def test_a_plane_is_met_exactly_and_the_error_of_a_bend_is_that_of_its_cells() -> None:
    grid = chosen_grid((-10.0, 10.0, -5.0, 5.0), None)
    assert (grid.columns, grid.rows, grid.cell, grid.middle) == (201, 101, 0.1, (0.0, 0.0))
    notes: list[str] = []
    surface = surface_of(sheet(lambda x, y: 0.2 * x + 0.1 * y, 10.0, 5.0), grid, None, notes)
    assert surface.has_floor.all()
    assert not surface.left_over.any()
    assert surface.ground.height_at(3.33, -2.5) == pytest.approx(0.416, abs=2e-6)
    (said,) = notes
    assert float(re.findall(r"by ([\d.e-]+) m at most", said)[0]) < 2e-6
    # A ridge between two vertices 0.1 m apart is cut off by half a cell times its slope.
    bent = sheet(lambda x, _: np.abs(x) / 3.0, 10.05, 10.05, 10.05 / 8)
    surface_of(bent, chosen_grid((-10.05, 10.05, -5.0, 5.0), 0.1), None, notes)
    assert "by 0.017 m at most, 99 % of them by less than 0.017 m" in notes[-1]


@pytest.mark.parametrize(
    ("width", "depth", "cell", "said"),
    [
        *(
            (10.0, 5e4, None, ""),
            (5e4, 10.0, None, ""),
            (20.0, 9.99, None, "it is 20 x 9.99 m; between"),
        ),
        (9.99, 20.0, None, "it is 9.99 x 20 m; between 10 and 50000 m can be driven; --mesh-unit"),
        *((*sides, None, "5e+04") for sides in ((50_001.0, 20.0), (20.0, 50_001.0))),
        (1500.0, 1500.0, 1.001, ""),
        (3000.0, 1500.0, None, ""),
        (1500.0, 1500.0, 1.0, "cells of 1 m are too many on 1500 x 1500 m; give --terrain-cell 1.001"),
    ],
)
def test_maps_of_ten_metres_to_fifty_kilometres_are_driven_in_cells_that_are_not_too_many(
    width: float, depth: float, cell: float | None, said: str
) -> None:
    bounds = (3.0, 3.0 + width, -7.0, -7.0 + depth)
    with pytest.raises(UsageError, match=re.escape(said)) if said else nullcontext():
        grid = chosen_grid(bounds, cell)
        assert grid.rows * grid.columns <= 1500 * 1500 + max(grid.rows, grid.columns)
        assert grid.cell == pytest.approx(cell or max(0.1, np.sqrt(width * depth) / 1499))


def test_beyond_the_outline_and_in_holes_there_are_pits_and_small_gaps_are_filled() -> None:
    """Of triangles of 25 cm some are missing; vertices 20 cm apart that lie within have no surface."""
    mesh = sheet(lambda x, _: 0.1 * x, 10.0, 10.0, 0.25)
    x, y = mesh.corners[:, :, 0].mean(axis=1), mesh.corners[:, :, 1].mean(axis=1)
    hole, lesser = (
        (np.abs(x - 4) < 1) & (np.abs(y) < 1),
        (np.abs(x - 3.75) < 0.75) & (np.abs(y - 5.375) < 0.125),
    )
    small, outside = (np.abs(x - 0.625) < 0.625) & (np.abs(y - 0.375) < 0.125), (x < -5) & (y > 5)
    nick = (x > 9.75) & (np.abs(y - 0.375) < 0.125)
    notes: list[str] = []
    grid = chosen_grid((-10.0, 10.0, -10.0, 10.0), 0.2)
    surface = surface_of(mesh.part(~(small | hole | lesser | outside | nick)), grid, None, notes)
    at = surface.ground.height_at
    assert at(0.6, 0.4) == pytest.approx(0.06, abs=0.02)  # 0.24 m2
    assert at(4.0, 0.0) == at(3.8, 5.4) == at(-8.0, 8.0) == at(10.0, 0.4) == pytest.approx(-3.0)
    assert at(8.0, 8.0) == pytest.approx(0.8)
    assert (~surface.has_floor).sum() == 6 + 9 * 9 + 7 + 25 * 25 + 2
    assert float(re.findall(r"by ([\d.e-]+) m at most", notes[-1])[0]) < 1e-5  # not of what is filled
    filled, pits = f"{6 / 101**2:.2%}", f"{(81 + 7 + 625 + 2) / 101**2:.1%}"
    assert notes[:-1] == [
        "2 holes without any surface, the largest of 3.24 m2: pits",
        f"{filled} of the map filled from its surroundings: small gaps",
        f"{pits} of the map has no surface: a pit there, 2 m below the lowest point",
    ]
    for part, said in ((small, "small gaps"), (outside, "below the lowest point")):
        notes.clear()
        surface_of(mesh.part(~part), grid, None, notes)
        assert [note.endswith(said) for note in notes] == [True, False]


def test_what_reaches_above_the_floor_is_left_over_and_what_is_buried_is_not() -> None:
    """A corner of the block is between vertices: no heightfield shows it, nor is its error said."""
    corner = at(7.44 - np.sqrt(2.0), 6.05, 0.2, 0.0, 0.0, np.pi / 4)
    block, buried = box((0, 0, 0), (2, 2, 1)).moved(corner), box((-6, -6, -1), (1, 1, 1))
    posts = [box((6.05, y, 0), (0.06, 0.06, 2 * top)) for y, top in ((-6.05, 0.06), (-3.05, 0.04))]
    mesh = both(flat(0.0), box((0, 0, 2.0), (4, 4, 0.5)), block, buried, *posts)
    notes: list[str] = []
    surface = surface_of(mesh, chosen_grid((-10.0, 10.0, -10.0, 10.0), 0.1), None, notes)
    assert notes[0].startswith("heights differ from the mesh by 0.04 m at most")  # of what is shown
    assert surface.ground.height_at(0.0, 0.0) == 0.0
    assert surface.ground.height_at(6.0, 6.0) == pytest.approx(0.7)  # too low to pass under: solid
    left = mesh.corners[surface.left_over]
    is_post = left[:, :, 1].max(axis=1) < -6.0  # but for its end below
    bounds = [(part.min(axis=(0, 1)), part.max(axis=(0, 1))) for part in (left[is_post], left[~is_post])]
    expected = [[(6.02, -6.08, -0.06), (6.08, -6.02, 0.06)], [(-2.0, -2.0, 1.75), (2.0, 2.0, 2.25)]]
    np.testing.assert_allclose(bounds, expected)
    assert (is_post.sum(), len(left)) == (10, 22)


def test_a_mesh_that_faces_down_alone_is_refused() -> None:
    under = Mesh(flat(0.0).vertices, flat(0.0).faces[:, ::-1])
    with pytest.raises(UsageError, match="nothing of it faces up"):
        surface_of(under, chosen_grid((-9.0, 9.0, -9.0, 9.0), 0.5), None, [])
