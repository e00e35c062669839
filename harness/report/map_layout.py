"""What the map shows at first, on axes of one scale, over the terrain as a picture."""

from collections.abc import Sequence

import numpy as np

from harness.page.figure import AXIS, Layout, common_layout
from harness.report.hillshade import Hillshade
from harness.report.recorder import Stretch

MARGIN, SHORTEST_SIDE = 2.0, 8.0  # [m] around the path and of the first view


def map_layout(half_size: float, hillshade: Hillshade, track: Sequence[Stretch]) -> Layout:
    """Lays out the map of a square terrain, from -half_size to half_size [m] on both axes."""
    x_range, y_range = _view(track, half_size)
    picture = {
        "source": hillshade.data_uri(),
        "xref": "x",
        "yref": "y",
        "x": hillshade.west,
        "y": hillshade.north,
        "sizex": hillshade.side,
        "sizey": hillshade.side,
        "sizing": "stretch",
        "opacity": "--ground-opacity",
        "layer": "below",
    }
    axis = AXIS | {"showgrid": False, "constrain": "domain", "automargin": False}
    return common_layout(
        images=[picture],
        xaxis=axis | {"title": {"text": "x [m]"}, "range": x_range},
        yaxis=axis | {"title": {"text": "y [m]"}, "range": y_range, "scaleanchor": "x"},
        margin={"l": 56, "r": 16, "t": 70, "b": 44},
        hovermode="closest",
    )


def _view(track: Sequence[Stretch], half_size: float) -> tuple[list[float], list[float]]:
    """A square around the path, no larger than the map."""
    if not track:
        return [-half_size, half_size], [-half_size, half_size]
    places = np.array([stretch.position[:2] for stretch in track])
    middle, extent = (places.min(axis=0) + places.max(axis=0)) / 2, np.ptp(places, axis=0).max()
    half = min(max(extent / 2 + MARGIN, SHORTEST_SIDE / 2), half_size)
    middle = np.clip(middle, half - half_size, half_size - half)
    x, y = ([round(m - half, 2), round(m + half, 2)] for m in middle.tolist())
    return x, y
