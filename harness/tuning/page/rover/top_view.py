"""A rover from above: footprint, lidar, the circles of its thresholds, and where a touch is not told."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from harness.robots import RoverSpec
from harness.tuning.page.reach import blind_strips, reach
from harness.tuning.page.rover.svg import WIDTH, View, drawing, hatch, label, tag
from harness.tuning.page.silhouette import ABOVE, silhouette

MARGIN, STRIP = 0.06, 0.035  # [m] around everything, and the width of a strip beside the outline
SCALE_BAR = 0.2  # [m]


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


@dataclass(frozen=True)
class Frame:
    """What is in the picture [m]."""

    left: float
    right: float
    half_height: float


def frame(rovers: Sequence[tuple[RoverSpec, Distances]]) -> Frame:
    """The smallest that holds all rovers, so that they are drawn to one scale."""
    boxes = [_box(rover, distances) for rover, distances in rovers]
    left, right, half = (list(values) for values in zip(*boxes, strict=True))
    return Frame(min(left) - MARGIN, max(right) + MARGIN, max(half) + MARGIN)


def _box(rover: RoverSpec, distances: Distances) -> tuple[float, float, float]:
    x_min, x_max, y_min, y_max = rover.footprint
    radius = max(distances.range_min, distances.default, distances.tuned or 0.0)
    grown = max(2 * STRIP, distances.clearance or 0.0)
    return (
        min(rover.lidar_x - radius, x_min - grown),
        max(rover.lidar_x + radius, x_max + grown),
        max(radius, y_max + grown, grown - y_min),
    )


def top_view(rover: RoverSpec, distances: Distances, frame: Frame) -> Markup:
    """The picture, front to the right."""
    view = View(frame.left, frame.half_height, WIDTH / (frame.right - frame.left))
    height = 2 * frame.half_height * view.scale
    parts = [
        *(tag("path", d=view.outline(shape), class_="rover") for shape in silhouette(rover, ABOVE)),
        *_strips(rover, distances, view),
        tag("path", d=view.rectangle(*rover.footprint), class_="footprint"),
        *_circles(rover, distances, view),
        view.circle(rover.lidar_x, 0.0, 0.012, class_="lidar"),
        *_notes(view, height),
    ]
    summary = f"{rover.name} from above, to scale, with its footprint, its lidar and its thresholds"
    return drawing(height, summary, parts)


def _strips(rover: RoverSpec, distances: Distances, view: View) -> Iterator[Markup]:
    """Hatched beside those parts of the outline at which a touch is not told."""
    yield _strip(rover, view, "default", 0.0, (distances.range_min, distances.default))
    if distances.tuned is not None:
        yield _strip(rover, view, "tuned", STRIP, (distances.range_min, distances.tuned))


def _strip(rover: RoverSpec, view: View, kind: str, start: float, told: tuple[float, float]) -> Markup:
    name = f"{rover.name}-{kind}"
    strips = blind_strips(rover, *told, start, STRIP)
    outlines = "".join(view.outline(strip) for strip in strips)
    return hatch(name, f"{kind}-hatch", crossed=kind == "tuned") + tag(
        "path", d=outlines, fill=f"url(#{name})"
    )


def _circles(rover: RoverSpec, distances: Distances, view: View) -> Iterator[Markup]:
    if distances.clearance is not None:
        x_min, x_max, y_min, y_max = rover.footprint
        yield tag(
            "rect",
            x=view.x(x_min - distances.clearance),
            y=view.y(y_max + distances.clearance),
            width=(x_max - x_min + 2 * distances.clearance) * view.scale,
            height=(y_max - y_min + 2 * distances.clearance) * view.scale,
            rx=distances.clearance * view.scale,
            class_="clearance",
        )
    yield view.circle(rover.lidar_x, 0.0, distances.range_min, class_="range-min")
    yield view.circle(rover.lidar_x, 0.0, distances.default, class_="default")
    if distances.tuned is not None:
        yield view.circle(rover.lidar_x, 0.0, distances.tuned, class_="tuned")


def _notes(view: View, height: float) -> Iterator[Markup]:
    """A bar for the scale and an arrow to the front."""
    length, low = SCALE_BAR * view.scale, height - 6.0
    yield tag("path", d=f"M6 {low - 4:.1f}v4h{length:.1f}v-4", class_="ink-line")
    yield label(6.0 + length / 2, low - 7, f"{SCALE_BAR:g} m")
    yield tag("path", d=f"M{WIDTH - 30:.1f} {low - 2:.1f}h22m-6 -5l6 5l-6 5", class_="ink-line")
    yield label(WIDTH - 34, low + 2, "front", "end")


def told_share(rover: RoverSpec, distances: Distances, threshold: float) -> str:
    """In words, how much of the outline a threshold covers."""
    covered = reach(rover, distances.range_min, threshold)
    return (
        f"{_percent(covered.too_far)} of the outline lies beyond it, "
        f"{_percent(covered.too_near)} nearer than range_min"
    )


def _percent(share: float) -> str:
    return f"{math.floor(100 * share + 0.5)} %"
