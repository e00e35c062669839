import numpy as np
import pytest

from harness.report.hillshade import map_layout, shade
from harness.report.recorder import Stretch
from harness.world.heightfield import Heightfield


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
