"""Both drawings of each rover, with their key."""

from collections.abc import Iterator, Sequence

from harness.page.figure import DASHES, INK, METRIC, MUTED, TIMES, Key
from harness.robots import RoverSpec, find_rover
from harness.sensors.lidar_spec import LidarSpec
from harness.tuning.page.layout import Cell, Drawing
from harness.tuning.page.rover.side_view import side_view
from harness.tuning.page.rover.top_view import Distances, frame, told_share, top_view
from harness.tuning.page.traces import OTHER, chosen
from harness.tuning.scoring.alarms import DETECTORS, footprint_clearance
from harness.tuning.scoring.collision import CollisionStudy
from harness.tuning.scoring.study import RobotStudy

CLEARANCE = next(name for name, told in DETECTORS.items() if told is footprint_clearance)
BLIND = "--truth"


def drawings(studies: Sequence[RobotStudy]) -> tuple[Cell, ...]:
    """A cell for each robot, all to one scale."""
    rovers = [find_rover(study.robot) for study in studies]
    distances = [_distances(study.collision) for study in studies]
    room = frame(list(zip(rovers, distances, strict=True)))
    cells = []
    for study, rover, around in zip(studies, rovers, distances, strict=True):
        pictures = (top_view(rover, around, room), side_view(rover, rovers))
        legend = tuple(_legend(rover, around, chosen(study.collision.verdict)))
        cells.append(Cell(study.robot, Drawing(pictures, legend)))
    return tuple(cells)


def _distances(study: CollisionStudy) -> Distances:
    tuned = study.verdict.tuned
    clearance = [told.events.value for told in study.detectors if told.name == CLEARANCE]
    return Distances(
        range_min=LidarSpec().range_min,
        default=study.verdict.default.value,
        tuned=None if tuned is None else tuned.value,
        clearance=clearance[0] if clearance else None,
    )


def _legend(rover: RoverSpec, around: Distances, name: str) -> Iterator[Key]:
    yield Key(f"footprint, {rover.length:.2f} {TIMES} {rover.width:.2f} m", "line", INK)
    yield Key(
        f"lidar, {rover.lidar_x:.3f} m ahead of the middle, {rover.lidar_height:.3f} m up",
        "circle",
        METRIC,
    )
    yield Key(f"range_min {around.range_min:g} m", "line", MUTED, DASHES["dot"])
    yield Key(f"default collision_threshold {around.default:g} m", "line", INK, DASHES["dash"])
    if around.tuned is not None:
        yield Key(f"{name} collision_threshold {around.tuned:g} m", "line", METRIC)
    if around.clearance is not None:
        yield Key(f"best footprint clearance {around.clearance:g} m", "line", OTHER, DASHES["dashdot"])
    yield Key(f"not told with the default: {told_share(rover, around, around.default)}", "hatch", BLIND)
    if around.tuned is not None:
        yield Key(
            f"not told with that value: {told_share(rover, around, around.tuned)}", "cross", METRIC
        )
    yield Key("below the plane of the lidar: never seen", "hatch", MUTED)
