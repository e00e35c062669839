"""SVG as text: elements, and metres on a drawing's own scale."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike

WIDTH = 340.0  # of every drawing, in its own units: one is a pixel on a phone


def tag(name: str, *content: str, **attributes: object) -> Markup:
    """An element; an underscore in the name of an attribute stands for a dash."""
    words = Markup("").join(
        Markup(' {}="{}"').format(key.rstrip("_").replace("_", "-"), _short(value))
        for key, value in attributes.items()
    )
    return Markup("<{0}{1}>{2}</{0}>").format(name, words, Markup("").join(content))


def label(x: float, y: float, text: str, anchor: str = "middle", **attributes: object) -> Markup:
    """A word at a place."""
    return tag("text", text, x=x, y=y, text_anchor=anchor, **attributes)


@dataclass(frozen=True)
class View:
    """From metres, y or z upwards, to the units of a drawing.

    Attributes:
        left: The x at the drawing's left edge [m]; `top` likewise.
        scale: Units to a metre.
    """

    left: float
    top: float
    scale: float

    def x(self, metres: float) -> float:
        """Of a place, from the left edge."""
        return (metres - self.left) * self.scale

    def y(self, metres: float) -> float:
        """Of a place, from the upper edge."""
        return (self.top - metres) * self.scale

    def outline(self, points: ArrayLike) -> str:
        """Path data of a closed polygon, points of shape (n, 2) [m]."""
        places = (np.asarray(points) - (self.left, self.top)) * (self.scale, -self.scale)
        return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places.tolist()) + "z"

    def rectangle(self, x_min: float, x_max: float, y_min: float, y_max: float) -> str:
        """Path data of a rectangle [m]."""
        return self.outline([(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)])

    def circle(self, x: float, y: float, radius: float, **attributes: object) -> Markup:
        """A circle [m]."""
        return tag("circle", cx=self.x(x), cy=self.y(y), r=radius * self.scale, **attributes)


def drawing(height: float, summary: str, parts: Iterable[Markup]) -> Markup:
    """A whole picture."""
    return tag(
        "svg",
        *parts,
        viewBox=f"0 0 {WIDTH:g} {height:.0f}",
        role="img",
        aria_label=summary,
        class_="drawing",
    )


def hatch(name: str, kind: str, *, crossed: bool = False) -> Markup:
    """A pattern of lines that `fill="url(#name)"` uses; its colour is that of the class."""
    path = "M0 6L6 0M-1 1L1 -1M5 7L7 5" + ("M0 0L6 6" if crossed else "")
    stripes = tag("path", d=path, class_=kind)
    return tag("pattern", stripes, id=name, width=6, height=6, patternUnits="userSpaceOnUse")


def _short(value: object) -> object:
    return f"{value:.1f}" if isinstance(value, float) else value
