"""A rover from above and from the side, as SVG: what its lidar tells of a touch, and what it cannot see.

matplotlib draws; its colours become custom properties of the page's style sheet, for light and dark.
"""

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch, Polygon, Rectangle

from harness.robots import RoverSpec
from harness.tune.page.outline import ABOVE, SIDE, silhouette, untold_strips
from harness.world.terrains.posts import CUBE, POST_HEIGHT

WIDTH, BELOW_GROUND = 340.0, 54.0  # of a drawing and of the text under its ground [px on a phone]
MARGIN, STRIP = 0.06, 0.035  # [m] around everything, and the width of a strip beside the outline
SCALE_BAR, GAP, AIR = 0.2, 0.18, 0.2  # [m] of the bar, between hazards, above everything
NAMES = ("ink", "muted", "line", "panel", "metric", "truth", "scan", "rock", "hazard")
COLORS = {name: f"#c010{number:02x}" for number, name in enumerate(NAMES)}  # stand-ins for the page's
INK, MUTED, LINE, PANEL, METRIC, TRUTH, SCAN, ROCK, HAZARD = COLORS.values()
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "font.size": 12.5,
    "font.family": "DejaVu Sans",
    "text.color": INK,
}

NOT_IN_HTML = r'<defs>\s*<style.*?</defs>|<metadata>.*?</metadata>| id="[a-z0-9]+_\d+"'


@dataclass(frozen=True)
class Distances:
    """What is drawn around a rover.

    Attributes:
        range_min: Of the lidar [m].
        default: The collision threshold's default [m]; `tuned` is None where there is none.
        clearance: Tuned threshold of the distance to the footprint [m], likewise.
    """

    range_min: float
    default: float
    tuned: float | None
    clearance: float | None

    def box(self, rover: RoverSpec) -> tuple[float, float, float]:
        """Returns how far all of this reaches to the left, to the right and sideways [m]."""
        x_min, x_max, y_min, y_max = rover.footprint
        radius = max(self.range_min, self.default, self.tuned or 0.0) + MARGIN
        grown = max(2 * STRIP, self.clearance or 0.0) + MARGIN
        return (
            max(radius - rover.lidar_x, grown - x_min),
            max(rover.lidar_x + radius, x_max + grown),
            max(radius, y_max + grown, grown - y_min),
        )


@dataclass(frozen=True, slots=True)
class Hazard:
    """What stands in front of the rover: its smallest height [m] and its largest."""

    name: str
    width: float
    low: float
    high: float

    @property
    def height(self) -> str:
        """Its height, as the drawing labels it."""
        return f"{self.low:g} m" if self.low == self.high else f"{self.low:g} to {self.high:g} m"

    def seen(self, plane: float) -> str:
        """Returns whether a lidar at that height [m] sees it."""
        if self.low > plane:
            return "seen"
        return "not seen" if self.high <= plane else "some seen"

    def outline(self, left: float, height: float) -> np.ndarray:
        """Returns its corners, shape (n, 2) [m], from its left end on."""
        if self.name != "boulder":
            return np.array([(left + x, z) for x in (0, self.width) for z in (0, height)])[[0, 1, 3, 2]]
        turn, radius = np.linspace(0.0, np.pi, 40), self.width / 2
        return np.column_stack([left + radius * (1 - np.cos(turn)), height * np.sin(turn)])


# The boulder is one of the squat ones of harness.world.terrains.rocky, the heights those that show.
HAZARDS = (
    Hazard("cube", CUBE, CUBE, CUBE),
    Hazard("boulder", 0.9, 0.5, 0.85),
    Hazard("post", 0.2, POST_HEIGHT, POST_HEIGHT),
)


def drawings(rovers: Sequence[tuple[RoverSpec, Distances]]) -> list[Markup]:
    """Returns an SVG for each rover, all to one scale, front to the right."""
    left, right, half = np.max([around.box(rover) for rover, around in rovers], axis=0)
    above = (-left, right, -half, half)
    back = min(rover.footprint[0] for rover, _ in rovers) - GAP
    front = max(rover.footprint[1] for rover, _ in rovers) + GAP
    end = front + sum(hazard.width + GAP for hazard in HAZARDS)
    top = max(HAZARDS[1].high, *(rover.lidar_height for rover, _ in rovers)) + AIR
    side = (back, end, -BELOW_GROUND * (end - back) / WIDTH, top)
    return [_drawing(rover, around, above, side, front) for rover, around in rovers]


Extent = tuple[float, float, float, float]  # left, right, bottom, top [m]


def _drawing(rover: RoverSpec, around: Distances, above: Extent, side: Extent, front: float) -> Markup:
    heights = [WIDTH * (top - bottom) / (right - left) for left, right, bottom, top in (side, above)]
    with mpl.rc_context({**STYLE, "svg.hashsalt": rover.name}):
        figure = Figure((WIDTH / 72, sum(heights) / 72), dpi=72)
        share = heights[0] / sum(heights)
        below = figure.add_axes((0, 0, 1, share), xlim=side[:2], ylim=side[2:])
        _draw_side(below, rover, front)
        top = figure.add_axes((0, share, 1, 1 - share), xlim=above[:2], ylim=above[2:])
        _draw_top(top, rover, around)
        for axes in (below, top):
            axes.axis("off")
        figure.patch.set_visible(False)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    return _for_page(text.getvalue(), rover, sum(heights))


def _draw_top(axes: Axes, rover: RoverSpec, around: Distances) -> None:
    for shape in silhouette(rover, ABOVE):
        axes.add_patch(Polygon(shape, color=LINE, lw=0))
    _hatch_untold(axes, rover, around)
    x_min, x_max, y_min, y_max = rover.footprint
    corner, length, width = (x_min, y_min), x_max - x_min, y_max - y_min
    axes.add_patch(Rectangle(corner, length, width, fill=False, ec=INK, lw=1.5))
    if around.clearance is not None:
        style = f"Round,pad={around.clearance},rounding_size={around.clearance}"
        axes.add_patch(
            FancyBboxPatch(corner, length, width, style, fill=False, ec=SCAN, ls="-.", lw=1.5)
        )
    rings = ((around.range_min, MUTED, ":"), (around.default, INK, "--"), (around.tuned, METRIC, "-"))
    for radius, color, dash in rings:
        if radius is not None:
            axes.add_patch(Circle((rover.lidar_x, 0), radius, fill=False, ec=color, ls=dash, lw=1.8))
    axes.add_patch(Circle((rover.lidar_x, 0), 0.012, fc=PANEL, ec=METRIC, lw=2))
    (left, right), (low, _) = axes.get_xlim(), axes.get_ylim()
    axes.plot([left + 0.02, left + 0.02 + SCALE_BAR], [low + 0.02] * 2, color=INK, marker="|", lw=1.5)
    axes.text(left + 0.02 + SCALE_BAR / 2, low + 0.04, f"{SCALE_BAR:g} m", ha="center")
    arrow = {"arrowstyle": "->", "color": INK, "lw": 1.5}
    end, start = (right - 0.02, low + 0.03), (right - 0.1, low + 0.03)
    axes.annotate("front", end, start, ha="right", va="center", arrowprops=arrow)


def _hatch_untold(axes: Axes, rover: RoverSpec, around: Distances) -> None:
    """Hatches strips beside those parts of the outline at which a touch is not told."""
    for threshold, start, hatch, color in (
        (around.default, 0.0, "////", TRUTH),
        (around.tuned, STRIP, "xxxx", METRIC),
    ):
        if threshold is not None:
            for strip in untold_strips(rover, (around.range_min, threshold), start, STRIP):
                axes.add_patch(Polygon(strip, fill=False, hatch=hatch, ec=color, lw=0))


def _draw_side(axes: Axes, rover: RoverSpec, front: float) -> None:
    (left, end), top, plane = axes.get_xlim(), axes.get_ylim()[1], rover.lidar_height
    below = Rectangle((left, 0), end - left, plane, fill=False, hatch="///", ec=LINE, lw=0, alpha=0.5)
    axes.add_patch(below)
    for hazard in HAZARDS:  # what only the largest have is dashed, what the picture cuts off stays open
        high, low = (hazard.outline(front, min(z, top + 0.1)) for z in (hazard.high, hazard.low))
        axes.add_patch(Polygon(high, fill=False, ec=HAZARD, ls="--"))
        axes.add_patch(Polygon(low, fc=ROCK, ec=HAZARD, alpha=0.8))
        for row, text in enumerate((hazard.name, hazard.height, hazard.seen(plane)), start=1):
            place = (front + hazard.width / 2, 0)
            axes.annotate(text, place, (0, -15.5 * row), textcoords="offset points", ha="center")
        front += hazard.width + GAP
    for shape in silhouette(rover, SIDE):
        axes.add_patch(Polygon(shape, color=LINE, lw=0))
    axes.axhline(0.0, color=INK, lw=1.5)
    axes.axhline(plane, color=METRIC, lw=2)
    axes.text(left + 0.02, plane + 0.03, f"lidar {plane:.2f} m")


def _for_page(svg: str, rover: RoverSpec, height: float) -> Markup:
    """Within HTML, where a style element would hold for the whole page and no name may occur twice."""
    plane = rover.lidar_height
    hazards = (f"{hazard.name} of {hazard.height}: {hazard.seen(plane)}" for hazard in HAZARDS)
    summary = (
        f"{rover.name} to scale, from above with its footprint, its lidar and its thresholds, and from "
        f"the side; its lidar is {plane:.2f} m up. {', '.join(hazards)}"
    )
    body = svg[svg.index(">", svg.index("<svg")) + 1 :]
    body = re.sub(NOT_IN_HTML, "", body, flags=re.DOTALL)
    for name, color in COLORS.items():
        body = body.replace(color, f"var(--{name})")
    head = Markup('<svg viewBox="0 0 {:g} {:.1f}" role="img" aria-label="{}" class="drawing">')
    return head.format(WIDTH, height, summary) + Markup(body)  # noqa: S704 - matplotlib's, of our names
