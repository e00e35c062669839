"""The views that a lens's image is put together from: OpenGL draws flat ones of less than 180 degrees.

A pinhole is one view. A fisheye looks up each of its pixels in the faces of a cube around it, of which
only those, and only the parts of them, are drawn that it sees.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.sensors.camera.lens import Equidistant, Lens

Doubles = NDArray[np.float64]
Pixels = NDArray[np.uint8]

# Ahead, right, left, down, up, behind: right, down and ahead of each in the optical frame, by rows.
FACES = np.array(
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[0, 0, -1], [0, 1, 0], [1, 0, 0]],
        [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
        [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
        [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
        [[-1, 0, 0], [0, 1, 0], [0, 0, -1]],
    ],
    dtype=np.float64,
)
MARGIN = 1.0  # [pixels] around what is looked up, for its neighbours


@dataclass(frozen=True, eq=False)
class View:
    """A flat image that is part of a camera's; edges are tangents of angles off `ahead`."""

    axes: Doubles  # its right, down and ahead in the camera's optical frame, by rows
    left: float
    right: float
    top: float
    bottom: float
    width: int  # [pixels]
    height: int  # [pixels]


class Assembly:
    """How the image of a lens is made of `views`, which are to be drawn."""

    def __init__(self, lens: Lens) -> None:
        self._shape = (lens.height, lens.width, 3)
        self._sources: NDArray[np.int64] | None = None
        if isinstance(lens, Equidistant):
            self.views = self._cube(lens)
        else:
            x, y = 0.5 * lens.width / lens.focal, 0.5 * lens.height / lens.focal
            self.views = (View(FACES[0], -x, x, -y, y, lens.width, lens.height),)

    def _cube(self, lens: Equidistant) -> tuple[View, ...]:
        """The parts of a cube's faces that the lens sees; notes where in them each pixel is."""
        directions = lens.directions().reshape(-1, 3)
        ahead = directions @ FACES[:, 2].T
        face_of = np.where(np.isnan(ahead[:, 0]), -1, np.argmax(ahead, axis=1))
        self._sources = np.zeros((4, len(directions)), np.int64)
        self._weights = np.zeros((4, len(directions), 1), np.float32)
        views, start = [], 1  # pixel 0 is black
        for face, axes in enumerate(FACES):
            looked_up = np.flatnonzero(face_of == face)
            if looked_up.size:
                right, down, depth = axes @ directions[looked_up].T
                view = _around(axes, right / depth, down / depth, lens.focal)
                self._look_up(looked_up, right / depth, down / depth, view, start)
                views.append(view)
                start += view.width * view.height
        return tuple(views)

    def _look_up(
        self, pixels: NDArray[np.int64], x: Doubles, y: Doubles, view: View, start: int
    ) -> None:
        """Notes four neighbours in a view, whose pixels begin at `start`, and their bilinear weights."""
        assert self._sources is not None  # noqa: S101 - for the type checker
        column = (x - view.left) / (view.right - view.left) * view.width - 0.5
        row = (y - view.top) / (view.bottom - view.top) * view.height - 0.5
        left, above = column.astype(np.int64), row.astype(np.int64)
        u, v = column - left, row - above
        first = start + above * view.width + left
        for k, (beside, below) in enumerate(((0, 0), (1, 0), (0, 1), (1, 1))):
            self._sources[k, pixels] = first + beside + below * view.width
            self._weights[k, pixels, 0] = (u if beside else 1 - u) * (v if below else 1 - v)

    def image(self, drawn: list[Pixels]) -> Pixels:
        """Returns the camera's image of its views, each of shape (height, width, 3)."""
        if self._sources is None:
            return drawn[0]
        table = np.concatenate([np.zeros((1, 3), np.uint8), *(view.reshape(-1, 3) for view in drawn)])
        total = np.full((self._sources.shape[1], 3), 0.5, np.float32)  # rounds
        for sources, weights in zip(self._sources, self._weights, strict=True):
            total += weights * table[sources]
        return total.astype(np.uint8).reshape(self._shape)


def _around(axes: Doubles, x: Doubles, y: Doubles, focal: float) -> View:
    """The view that holds these tangents, with a margin, as finely as the lens resolves its middle."""
    margin = MARGIN / focal
    width, height = (int(np.ceil(np.ptp(t) * focal + 2.0 * MARGIN)) for t in (x, y))
    left, top = float(x.min() - margin), float(y.min() - margin)
    return View(axes, left, left + width / focal, top, top + height / focal, width, height)
