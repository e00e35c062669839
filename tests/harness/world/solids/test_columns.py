"""Which of several surfaces one stands on: worked out by hand for stacks of sheets and boxes."""

import numpy as np
import pytest

from harness.world.heightfield import Heightfield
from harness.world.solids import columns
from harness.world.solids.columns import Grid, crossings, floors
from harness.world.solids.mesh_file import Mesh
from tests.harness.world.solids.shapes import both, box, flat, sheet

GRID = Grid(-2.0, -2.0, 1.0, 5, 5)
NOTHING = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int64))


def downwards(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces[:, ::-1])


@pytest.mark.parametrize(
    ("mesh", "plane", "floor"),
    [
        (flat(1.5), None, 1.5),
        (both(flat(0.0), box((0, 0, 2.0), (6, 6, 1))), None, 0.0),  # a bridge: one passes under it
        (both(flat(0.0), box((0, 0, 1), (6, 6, 1)), box((0, 0, 4), (6, 6, 1))), None, 1.5),  # too low
        (both(flat(0.0), box((0, 0, 1.5), (6, 6, 1))), None, 0.0),  # just the headroom
        (both(flat(0.0), box((0, 0, 0.4), (6, 6, 1.0))), None, 0.9),  # in the ground: solid
        (both(flat(0.0), box((0, 0, 1.5), (6, 6, 4.0))), None, 0.0),  # sticks out far: stands on it
        (both(flat(0.0), box((0, 0, 1.5), (6, 6, 3.0))), None, 0.0),  # and so it does from there on
        (both(flat(0.0), flat(2.0)), None, 0.0),  # a sheet high up is a ceiling
        (both(flat(0.0), flat(0.4)), None, 0.4),  # a ramp of no thickness
        (both(flat(0.0), flat(2.0)), 0.5, 2.0),  # over a plane, it is a hill
        (both(flat(0.5), flat(3.0)), 0.0, 0.5),  # a hill under a ceiling
        (box((0, 0, 2.0), (6, 6, 1)), 0.0, 0.0),  # a bridge over a plane
        (both(flat(0.5), flat(2.0)), 0.5, 0.5),  # ground at the plane's height is not the plane
        (flat(-3.0), 0.5, 0.5),
        (downwards(flat(2.0)), 0.0, 0.0),
        (downwards(flat(0.5)), 0.0, 0.0),
        (downwards(flat(0.5)), None, np.nan),
        (both(flat(0.0), downwards(flat(0.3)), flat(0.6), downwards(flat(0.9)), flat(3.0)), None, 3.0),
        (both(flat(0.0), downwards(flat(3.0)), flat(3.2), flat(3.3)), None, 0.0),
        *((NOTHING, 2.0, 2.0), (NOTHING, None, np.nan)),
    ],
)
def test_one_stands_on_the_lowest_floor_with_headroom(
    mesh: Mesh, plane: float | None, floor: float
) -> None:
    found = floors(crossings(mesh.corners, GRID), GRID, plane)
    assert found[2, 2] == pytest.approx(floor, nan_ok=True)


@pytest.mark.parametrize(
    "grid",
    [
        Grid(-4.0, -4.0, 0.25, 33, 33),
        Grid(-4.3, -3.9, 1.7, 5, 6),  # larger than a triangle
        Grid(-1.3, -0.9, 0.7, 3, 4),  # in the middle of it
    ],
)
def test_a_surface_is_met_at_every_vertex_within_its_outline_and_nowhere_else(
    grid: Grid, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Against the heightfield of the same triangles; edges and corners belong to it."""
    mesh = sheet(lambda x, y: np.sin(x) * y, 3.0, 2.0)
    field = Heightfield(np.sin(np.arange(-3.0, 4.0)) * np.arange(-2.0, 3.0)[:, None], 1.0)
    row, column = np.mgrid[: grid.rows, : grid.columns]
    x, y = grid.x + grid.cell * column, grid.y + grid.cell * row
    expected = np.where((np.abs(x) <= 3.0) & (np.abs(y) <= 2.0), field.heights_at(x, y), np.nan)
    for chunk in (columns.CHUNK, 50):
        monkeypatch.setattr(columns, "CHUNK", chunk)
        np.testing.assert_allclose(floors(crossings(mesh.corners, grid), grid), expected, atol=1e-9)
