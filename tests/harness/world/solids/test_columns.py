"""Which of several surfaces one stands on: worked out by hand for stacks of sheets and boxes."""

import numpy as np
import pytest

from harness.base.mesh import Mesh
from harness.world.solids.columns import Grid, crossings, floors
from tests.harness.world.solids.shapes import both, box, flat

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
