import numpy as np
import pytest

from harness.view.ground import MOST_HALVED, drawn
from harness.world.heightfield import Heightfield
from harness.world.world import build_world

CELL = 0.2
X, Y = np.meshgrid(np.arange(-60, 61) * CELL, np.arange(-50, 51) * CELL)
RADIUS = 6.0


def crater(cell: float = CELL) -> Heightfield:
    """A rim 3 m high: round, but its vertices are not."""
    r = np.hypot(X, Y) / CELL * cell
    return Heightfield(np.where(r < RADIUS, 3 * (r / RADIUS) ** 4, 3 * np.exp((RADIUS - r) / 0.6)), cell)


def rim(ground: Heightfield) -> np.ndarray:
    angles = np.linspace(0.0, 2 * np.pi, 2000)
    points = zip(RADIUS * np.cos(angles), RADIUS * np.sin(angles), strict=True)
    return np.array([ground.height_at(x, y) for x, y in points])


def test_a_sharp_crest_loses_its_teeth_and_little_of_its_height() -> None:
    raw, shown = rim(crater()), rim(drawn(crater()))
    assert np.ptp(raw) > 0.4
    assert np.ptp(shown) < 0.25 * np.ptp(raw)
    assert shown.mean() == pytest.approx(raw.mean(), abs=0.3)


def test_away_from_crests_the_ground_is_where_it_was() -> None:
    ground, shown = crater(), drawn(crater())
    assert (shown.cell, *shown.half_size) == pytest.approx((CELL / 2, *ground.half_size))
    away = abs(np.hypot(X, Y) - RADIUS) > 1.0
    np.testing.assert_allclose(shown.heights[::2, ::2][away], ground.heights[away], atol=0.02)


@pytest.mark.parametrize("name", ["rocky", "gravel", "washboard"])
def test_grain_and_gentle_ground_are_shown_as_they_are_driven(name: str) -> None:
    ground = build_world(name, 1, 1.0).ground
    assert drawn(ground) is ground


def test_cells_of_a_large_map_stay_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    assert crater().heights.size < MOST_HALVED
    monkeypatch.setattr("harness.view.ground.MOST_HALVED", crater().heights.size - 1)
    shown = drawn(crater())
    assert (shown.cell, shown.heights.shape) == (CELL, crater().heights.shape)
    assert np.ptp(rim(shown)) < 0.4 * np.ptp(rim(crater()))
