"""A rover from the side: the plane of its lidar, and what of the hazards lies below it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from harness.robots import RoverSpec
from harness.tuning.page.rover.svg import WIDTH, View, drawing, hatch, label, tag
from harness.tuning.page.silhouette import SIDE, silhouette
from harness.world.terrains.posts import CUBE, POST_HEIGHT

GAP, ABOVE_PLANE, BELOW_GROUND = 0.18, 0.2, 52.0  # [m] between things, [m] of air, units for words
POST_WIDTH = 0.2  # [m]
# Of the squat ones of harness.world.terrains.rocky [m]: length, lowest and highest that shows.
BOULDER_LENGTH, BOULDER_LOW, BOULDER_HIGH = 0.9, 0.5, 0.85


@dataclass(frozen=True, slots=True)
class Sketch:
    """A hazard in front of the rover.

    Attributes:
        low: Smallest height [m]; `high` the largest.
    """

    name: str
    width: float
    low: float
    high: float

    @property
    def height(self) -> str:
        """For people."""
        if self.low == self.high:
            return f"{self.low:g} m"
        return f"{self.low:g} to {self.high:g} m"

    def seen(self, plane: float) -> str:
        """Whether a lidar at that height sees it [m]."""
        if self.low > plane:
            return "seen"
        return "not seen" if self.high <= plane else "some seen"


HAZARDS = (
    Sketch("cube", CUBE, CUBE, CUBE),
    Sketch(
        "boulder",
        BOULDER_LENGTH,
        BOULDER_LOW,
        BOULDER_HIGH,
    ),
    Sketch("post", POST_WIDTH, POST_HEIGHT, POST_HEIGHT),
)


def side_view(rover: RoverSpec, rovers: Sequence[RoverSpec]) -> Markup:
    """The picture, front to the right.

    Args:
        rover: Which.
        rovers: All that are drawn, for one scale.
    """
    left = min(other.footprint[0] for other in rovers) - GAP
    start = max(other.footprint[1] for other in rovers) + GAP
    end = start + sum(hazard.width + GAP for hazard in HAZARDS)
    top = max(BOULDER_HIGH, *(other.lidar_height for other in rovers)) + ABOVE_PLANE
    view = View(left, top, WIDTH / (end - left))
    parts = [
        hatch(f"{rover.name}-below", "below-hatch"),
        tag(
            "path",
            d=view.rectangle(left, end, 0.0, rover.lidar_height),
            fill=f"url(#{rover.name}-below)",
        ),
        *_hazards(rover, view, start),
        *(tag("path", d=view.outline(shape), class_="rover") for shape in silhouette(rover, SIDE)),
        tag("path", d=view.rectangle(left, end, 0.0, 0.0), class_="ink-line"),
        tag("path", d=view.rectangle(left, end, rover.lidar_height, rover.lidar_height), class_="plane"),
        label(4.0, view.y(rover.lidar_height) - 5, f"lidar {rover.lidar_height:.2f} m", "start"),
    ]
    summary = (
        f"{rover.name} from the side, to scale; its lidar is {rover.lidar_height:.2f} m up. "
        + ", ".join(
            f"{hazard.name} of {hazard.height}: {hazard.seen(rover.lidar_height)}" for hazard in HAZARDS
        )
    )
    return drawing(top * view.scale + BELOW_GROUND, summary, parts)


def _hazards(rover: RoverSpec, view: View, start: float) -> Iterator[Markup]:
    for hazard in HAZARDS:
        yield from _hazard(hazard, view, start)
        middle, ground = view.x(start + hazard.width / 2), view.y(0.0)
        words = (hazard.name, hazard.height, hazard.seen(rover.lidar_height))
        for number, word in enumerate(words, start=1):
            yield label(middle, ground + 15.0 * number, word)
        start += hazard.width + GAP


def _hazard(hazard: Sketch, view: View, left: float) -> Iterator[Markup]:
    """Its outline; what only the largest have is dashed, what the picture cuts off stays open."""
    right = left + hazard.width
    for height, kind in ((hazard.high, "hazard-high"), (hazard.low, "hazard-low")):
        if hazard.name == "boulder":
            x, radius, ground = view.x(left), hazard.width / 2 * view.scale, view.y(0.0)
            arc = (
                f"M{x:.1f} {ground:.1f}a{radius:.1f} {height * view.scale:.1f} 0 0 1 {2 * radius:.1f} 0z"
            )
            yield tag("path", d=arc, class_=kind)
        else:
            yield tag(
                "path", d=view.rectangle(left, right, 0.0, min(height, view.top + 0.1)), class_=kind
            )
