"""A rover from above and from the side: where a touch raises an alarm, and what the lidar cannot see."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.page import figure as fig
from harness.page.figure import INK, METRIC, MUTED, SCAN, Plot, Trace
from harness.robots import RoverSpec
from harness.robots.lidar import LidarSpec
from harness.tune.page.outline import ABOVE, SIDE, Span, shares, silent_strips, silhouette
from harness.tune.page.subject import chosen
from harness.tune.scoring.alarms import FOOTPRINT_CLEARANCE
from harness.tune.scoring.collision import CollisionStudy
from harness.world.terrains.posts import CUBE, POST_HEIGHT

MARGIN, STRIP = 0.06, 0.035  # [m] around everything, and the width of a strip beside the outline
GAP, AIR = 0.25, 0.2  # [m] between hazards, above everything
TURN = np.linspace(0.0, 2 * np.pi, 73)
BODY, EDGE, FACE = "--line", "--hazard", "--rock"

Points = NDArray[np.float64]  # shape (n, 2) [m]


@dataclass(frozen=True, slots=True)
class Hazard:
    """What stands in front of the rover: its width [m], its smallest height [m] and its largest."""

    name: str
    width: float
    low: float
    high: float

    def label(self, plane: float) -> str:
        """Returns its name, its height and whether a lidar at a height [m] sees it."""
        height = f"{self.low:g} m" if self.low == self.high else f"{self.low:g} to {self.high:g} m"
        seen = "not seen" if self.high <= plane else "some seen"
        return f"{self.name}<br>{height}<br>{'seen' if self.low > plane else seen}"

    def outline(self, left: float, height: float) -> Points:
        """Returns its corners from its left end on."""
        if self.name != "boulder":
            ends = left, left + self.width
            return np.array([(ends[0], 0), (ends[0], height), (ends[1], height), (ends[1], 0)])
        turn, radius = TURN[: len(TURN) // 2 + 1], self.width / 2
        return np.column_stack([left + radius * (1 - np.cos(turn)), height * np.sin(turn)])


# The boulder is one of the squat ones of harness.world.terrains.rocky, the heights those that show.
HAZARDS = (
    Hazard("cube", CUBE, CUBE, CUBE),
    Hazard("boulder", 0.9, 0.5, 0.85),
    Hazard("post", 0.2, POST_HEIGHT, POST_HEIGHT),
)


def drawings(rovers: Sequence[tuple[str, RoverSpec, CollisionStudy]]) -> list[tuple[Plot, Plot]]:
    """Returns each rover from above and from the side, all to one scale, front to the right.

    `rovers` has, for each, its name on the page and its study of contacts.
    """
    above = [[*_above(rover, study)] for _, rover, study in rovers]
    points = np.concatenate([np.array([t["x"], t["y"]], float).T for traces in above for t in traces])
    low, high = np.nanmin(points, axis=0) - MARGIN, np.nanmax(points, axis=0) + MARGIN
    front = max(rover.footprint[1] for _, rover, _ in rovers) + GAP
    back = min(rover.footprint[0] for _, rover, _ in rovers) - GAP
    top = max(HAZARDS[1].high, *(rover.lidar_height for _, rover, _ in rovers)) + AIR
    end = front + sum(hazard.width + GAP for hazard in HAZARDS)
    return [
        (
            _plot(
                f"{name}-above",
                f"{name} to scale from above, with its footprint, its lidar and its thresholds",
                traces,
                fig.titled("ahead of the middle [m]", range=[low[0], high[0]]),
                fig.titled("to the left [m]", range=[low[1], high[1]]),
            ),
            _side(name, rover, (back, front, end), top),
        )
        for (name, rover, _), traces in zip(rovers, above, strict=True)
    ]


def _above(rover: RoverSpec, study: CollisionStudy) -> Iterator[Trace]:
    verdict, range_min = study.verdict, LidarSpec().range_min
    default, tuned = verdict.default.value, None if verdict.tuned is None else verdict.tuned.value
    yield _area(f"{rover.name}'s shape", silhouette(rover, ABOVE), BODY)
    yield _silent(rover, (range_min, default), 0.0, "/", fig.TRUTH)
    if tuned is not None:
        yield _silent(rover, (range_min, tuned), STRIP, "x", METRIC)
    x_min, x_max, y_min, y_max = rover.footprint
    corners = np.array([(x_max, y_max), (x_min, y_max), (x_min, y_min), (x_max, y_min)])
    size = f"footprint, {rover.length:.2f} {fig.TIMES} {rover.width:.2f} m"
    yield _line(size, corners[[0, 1, 2, 3, 0]], INK, width=1.5)
    best = {study.name: study.events.value for study in study.detectors}.get(FOOTPRINT_CLEARANCE)
    if best is not None:
        quarters, steps = np.divmod(np.arange(76), 19)  # of a circle, one at each corner
        around = np.repeat(corners, 19, axis=0) + best * _circle(18 * quarters + steps)
        name = f"best footprint clearance {best:g} m"
        yield _line(name, np.vstack([around, around[:1]]), SCAN, dash="dashdot", width=1.5)
    lidar = np.array([rover.lidar_x, rover.lidar_y])
    rings = (
        (f"range_min {range_min:g} m", range_min, MUTED, "dot"),
        (f"default {verdict.name} {default:g} m", default, INK, "dash"),
        (f"{chosen(verdict)} {verdict.name} {tuned} m", tuned, METRIC, "solid"),
    )
    for name, radius, color, dash in rings:
        if radius is not None:
            yield _line(name, lidar + radius * _circle(np.arange(73)), color, dash=dash)
    name = f"lidar, {rover.lidar_x:.3f} m ahead of the middle, {rover.lidar_height:.3f} m up"
    marker = {"symbol": "circle", "size": 8, "color": METRIC}
    yield {**_line(name, lidar[None], METRIC), "mode": "markers", "marker": marker}


def _silent(rover: RoverSpec, span: Span, start: float, shape: str, color: str) -> Trace:
    """Strips beside those parts of the outline at which a touch raises no alarm."""
    near, _, far = (f"{int(100 * share + 0.5)} %" for share in shares(rover, span))
    name = f"no alarm below {span[1]:g} m: {far} of the outline lies beyond it, {near} within range_min"
    return _hatched(name, silent_strips(rover, span, start, STRIP), shape, color)


def _side(name: str, rover: RoverSpec, places: tuple[float, float, float], top: float) -> Plot:
    back, left, end = places
    plane = rover.lidar_height
    below = np.array([(back, 0), (back, plane), (end, plane), (end, 0)])
    lefts = left + np.cumsum([0.0, *(hazard.width + GAP for hazard in HAZARDS[:-1])])
    standing = [*zip(HAZARDS, lefts.tolist(), strict=True)]
    # What only the largest have is dashed, what the picture cuts off stays open.
    least, most = (
        [hazard.outline(at, min(getattr(hazard, height), top + 1)) for hazard, at in standing]
        for height in ("low", "high")
    )
    data = [
        _hatched("below the plane of the lidar: never seen", [below], "/", MUTED),
        _area("hazards of the least height", least, FACE),
        _line("hazards of the largest height", _joined(most), EDGE, dash="dash", width=1.5),
        _area(f"{name}'s shape", silhouette(rover, SIDE), BODY),
        _line(f"plane of the lidar, {plane:.2f} m up", np.array([(back, plane), (end, plane)]), METRIC),
    ]
    labels = [hazard.label(plane) for hazard in HAZARDS]
    middles = [round(at + hazard.width / 2, 3) for hazard, at in standing]
    summary = f"{name} to scale from the side; its lidar is {plane:.2f} m up. {', '.join(labels)}"
    x = fig.AXIS | {"tickvals": middles, "ticktext": labels, "range": [back, end]}
    y = fig.titled("height [m]", range=[0.0, top])
    return _plot(f"{name}-side", summary.replace("<br>", " "), data, x, y)


def _plot(name: str, summary: str, data: list[Trace], x: fig.Layout, y: fig.Layout) -> Plot:
    """A figure with equal scales, as far as its place on the page lets both ranges stay."""
    alike = {"constrain": "domain", "showgrid": False}
    layout = fig.common_layout(xaxis=x | alike, yaxis=y | {"scaleanchor": "x"} | alike)
    return Plot(name, summary, {"data": data, "layout": layout})


def _circle(steps: NDArray[np.int_]) -> Points:
    """Points of a circle of 1 m, by steps of 5 degrees."""
    return np.column_stack([np.cos(TURN[steps % 72]), np.sin(TURN[steps % 72])])


def _line(name: str, points: Points, color: str, **style: object) -> Trace:
    return fig.line(name, points[:, 0], points[:, 1], color, hover=None, **style)


def _area(name: str, shapes: Iterable[Points], color: str) -> Trace:
    return _line(name, _joined(shapes), color, width=1) | {"fill": "toself", "fillcolor": color}


def _hatched(name: str, shapes: Iterable[Points], shape: str, color: str) -> Trace:
    pattern = {"shape": shape, "fgcolor": color, "bgcolor": "rgba(0,0,0,0)", "size": 6, "solidity": 0.25}
    return _line(name, _joined(shapes), color, width=0) | {"fill": "toself", "fillpattern": pattern}


def _joined(shapes: Iterable[Points]) -> Points:
    """Closed shapes in one trace, with nothing between them."""
    nothing = np.full((1, 2), np.nan)
    parts = [part for shape in shapes for part in (shape, shape[:1], nothing)]
    return np.concatenate(parts or [nothing])
