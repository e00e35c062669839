"""What stands in a figure of matplotlib as text: titles, axes, curves, marks and their looks."""

from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation
from numpy.typing import ArrayLike, NDArray

FEW = 4  # points that are written one by one


def described(figure: Figure | None) -> str:
    """Returns the figure as text, numbers with four digits; curves by ends, extremes and mean."""
    if figure is None:
        return "no figure\n"
    titles = [figure.get_suptitle(), figure.get_supxlabel()]
    lines = [f"{_numbers(figure.get_size_inches())} {titles}"]
    for axes in figure.axes:
        lines += _axes(axes)
    return "\n".join(lines) + "\n"


def _axes(axes: Axes) -> Iterator[str]:
    yield f"axes {axes.get_title(loc='left')!r} {axes.get_title(loc='right')!r}"
    for label, limits, ticks in (
        (axes.get_xlabel(), axes.get_xlim(), axes.get_xticklabels()),
        (axes.get_ylabel(), axes.get_ylim(), axes.get_yticklabels()),
    ):
        names = [tick.get_text() for tick in ticks if tick.get_text()[-1:].isalpha()]
        yield f"  {label!r} {_numbers(limits)} {names} {ticks[0].get_rotation() if ticks else 0:g}"
    for artist in (*axes.lines, *axes.collections, *axes.patches):
        yield f"  {_drawn(artist)}"
    for text in axes.texts:
        place = text.xy if isinstance(text, Annotation) else text.get_position()
        yield f"  {text.get_text()!r} {_numbers(place)} {to_hex(text.get_color())}"


def _drawn(artist: Artist) -> str:
    if isinstance(artist, Line2D):
        look = to_hex(artist.get_color()), artist.get_linestyle(), artist.get_linewidth()
        label = "" if str(artist.get_label()).startswith("_") else artist.get_label()
        points = np.array([artist.get_xdata(), artist.get_ydata()], dtype=np.float64).T
        return f"line {look} {artist.get_marker()} {artist.get_alpha()} {label} {_points(points)}"
    if isinstance(artist, Rectangle):
        corner = artist.get_x(), artist.get_y(), artist.get_width(), artist.get_height()
        return f"box {to_hex(artist.get_facecolor())} {_numbers(corner)}"
    assert isinstance(artist, Collection)
    places, paths = np.asarray(artist.get_offsets()), artist.get_paths()
    if not places.any():  # bands and bars, not marks
        places = np.concatenate([np.asarray(path.vertices) for path in paths] or [np.empty((0, 2))])
    colours = [*np.atleast_2d(artist.get_facecolor()), *np.atleast_2d(artist.get_edgecolor())]
    names = [to_hex(colour) for colour in colours if colour.size]
    kind = type(artist).__name__.removeprefix("FillBetween")  # its name before matplotlib 3.10
    return f"{kind} {names} {_points(places)}"


def _points(points: NDArray[np.float64]) -> str:
    known = points[np.isfinite(points[:, 1])] if len(points) else points
    if len(points) <= FEW or not len(known):
        return " ".join(map(_numbers, points))
    lowest, highest = known[np.argmin(known[:, 1])], known[np.argmax(known[:, 1])]
    named = {"from": points[0], "to": points[-1], "lowest": lowest, "highest": highest}
    ends = " ".join(f"{name} {_numbers(place)}" for name, place in named.items())
    return f"{len(points)} points, {len(known)} known, {ends}, mean {_numbers(known.mean(axis=0))}"


def _numbers(values: ArrayLike) -> str:
    rounded = (float(f"{value:.4g}") + 0.0 for value in np.ravel(np.asarray(values, np.float64)))
    return f"({', '.join(f'{value:.4g}' for value in rounded)})"
