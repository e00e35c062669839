"""Which of several surfaces one stands on: worked out by hand for stacks of sheets and boxes."""

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator

from harness.world.solids import columns
from harness.world.solids.columns import Grid, crossings, floors
from harness.world.solids.mesh_file import Mesh
from tests.harness.world.solids.shapes import both, box, flat, sheet

GRID = Grid(-2.0, -2.0, 1.0, 5, 5)


def floor_in_the_middle(mesh: Mesh, plane: float | None = None) -> float:
    return float(floors(crossings(mesh.corners, GRID), GRID, plane)[2, 2])


def downwards(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces[:, ::-1])


@pytest.mark.parametrize(
    ("mesh", "plane", "floor"),
    [
        (flat(1.5), None, 1.5),
        (both(flat(0.0), box((0, 0, 2.0), (6, 6, 1))), None, 0.0),  # a bridge: one passes under it
        (both(flat(0.0), box((0, 0, 1.0), (6, 6, 1))), None, 1.5),  # too low to pass under
        (both(flat(0.0), box((0, 0, 1.5), (6, 6, 1))), None, 0.0),  # just the headroom
        (both(flat(0.0), box((0, 0, 0.4), (6, 6, 1.0))), None, 0.9),  # in the ground: solid
        (
            both(flat(0.0), box((0, 0, 1.5), (6, 6, 4.0))),
            None,
            0.0,
        ),  # it sticks out of it far: stands on it
        (both(flat(0.0), flat(2.0)), None, 0.0),  # a sheet high up is a ceiling
        (both(flat(0.0), flat(0.4)), None, 0.4),  # a ramp of no thickness
        (both(flat(0.0), flat(2.0)), 0.5, 2.0),  # over a plane, it is a hill
        (flat(-3.0), 0.5, 0.5),
        (downwards(flat(2.0)), 0.0, 0.0),
        (downwards(flat(0.5)), 0.0, 0.0),
        (downwards(flat(0.5)), None, np.nan),
        (both(flat(0.0), downwards(flat(0.3)), flat(0.6), downwards(flat(0.9)), flat(3.0)), None, 3.0),
        (both(flat(0.0), downwards(flat(3.0)), flat(3.2), flat(3.3)), None, 0.0),
    ],
)
def test_one_stands_on_the_lowest_floor_with_headroom(
    mesh: Mesh, plane: float | None, floor: float
) -> None:
    assert floor_in_the_middle(mesh, plane) == pytest.approx(floor, nan_ok=True)


def test_a_surface_is_met_at_every_vertex_within_its_outline_and_nowhere_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Against scipy's linear interpolation in the same triangles; edges and corners belong to it."""
    rng = np.random.default_rng(2)
    mesh = sheet(lambda x, y: np.sin(x) * y, 3.0, 2.0)
    grid = Grid(-4.0, -4.0, 0.25, 33, 33)
    whole = floors(crossings(mesh.corners, grid), grid)
    monkeypatch.setattr(columns, "CHUNK", 50)
    np.testing.assert_array_equal(floors(crossings(mesh.corners, grid), grid), whole)
    y, x = np.mgrid[-4:4.01:0.25, -4:4.01:0.25]
    inside = (np.abs(x) <= 3.0) & (np.abs(y) <= 2.0)
    np.testing.assert_array_equal(np.isfinite(whole), inside)
    for triangle in mesh.corners[rng.integers(0, len(mesh.faces), 12)]:
        plane = LinearNDInterpolator(triangle[:, :2], triangle[:, 2])(x, y)
        held = np.isfinite(plane)
        np.testing.assert_allclose(whole[held], plane[held], atol=1e-9)


def test_without_triangles_there_is_the_plane_or_nothing() -> None:
    none = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int64))
    assert floor_in_the_middle(none, 2.0) == 2.0
    assert np.isnan(floor_in_the_middle(none))
