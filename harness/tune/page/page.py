"""The page of a tuning: what the template shows of each robot."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from harness import __version__
from harness.page.figure import DASHES, INK, METRIC, MUTED, SCAN, TIMES, TRUTH, Key, Plot, named
from harness.page.shell import fill
from harness.robots import RoverSpec, find_rover
from harness.sensors.lidar_spec import LidarSpec
from harness.tune.episodes.plan import Planned
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.page import tables
from harness.tune.page.contact_figures import contact_figures
from harness.tune.page.drawing import Distances, drawings
from harness.tune.page.ground_figures import ground_figures, steps_and_jumps
from harness.tune.page.outline import Told, shares
from harness.tune.page.scan_figures import scan_figures
from harness.tune.page.subject import Subject, chosen
from harness.tune.parameter_file import parameter_file
from harness.tune.scoring import alarms, clearance, estimate, imu_events
from harness.tune.scoring.collision import CollisionStudy
from harness.tune.scoring.imu_events import SIGNALS
from harness.tune.scoring.study import RobotStudy, conclusions, scored_records, unreachable
from rover_metrics.sheet.sheet import Sheet

NUMBERS = {  # of the method
    "gap": alarms.GAP,
    "rough": imu_events.ROUGH * 1e3,
    "horizon": clearance.HORIZON,
    "level": 100 * estimate.LEVEL,
    "resamples": estimate.RESAMPLES,
    "fewest": estimate.FEWEST_EPISODES,
}


def render(studies: Sequence[RobotStudy], records: Mapping[Planned, EpisodeRecord], command: str) -> str:
    """Returns the HTML of a tuning's report; the same arguments give the same bytes.

    Args:
        studies: One per robot, in the order of the page.
        records: All episodes that they were made from.
        command: What makes this page.
    """
    around = [(find_rover(study.robot), _distances(study.collision)) for study in studies]
    robots: list[dict[str, Any]] = [
        {
            "name": study.name,
            "conclusions": [*conclusions(study)],
            "unreachable": unreachable(study.collision),
            "file": parameter_file(study, command),
            "items": _items(Subject(study, scored_records(study.robot, records))),
            "drawing": drawn,
            "legend": [*_legend(study, *one)],
        }
        for study, one, drawn in zip(studies, around, drawings(around), strict=True)
    ]
    plots = [item for robot in robots for item in robot["items"].values() if isinstance(item, Plot)]
    content = {
        "robots": robots,
        "signals": SIGNALS,
        "command": command,
        "version": __version__,
        "figures": named(plots),
        "numbers": NUMBERS,
    }
    return fill("tuning", content, package="harness.tune.page")


def _items(robot: Subject) -> dict[str, Plot | Sheet | str]:
    """Every table and figure of a robot, or why there is none, by its name in the template."""
    study = robot.study
    return {
        **contact_figures(robot),
        **scan_figures(robot),
        **ground_figures(robot),
        "steps": steps_and_jumps(robot),
        "thresholds": tables.thresholds(study),
        "detectors": tables.detectors(study.collision),
        "zones": tables.zones(study.collision),
        "sum": tables.clearance(study),
        "driven": tables.driven(study),
        **{verdict.name: tables.measures(verdict) for verdict in study.verdicts},
        **{f"{ground.verdict.name}-speeds": tables.speeds(ground) for ground in study.grounds},
    }


def _distances(study: CollisionStudy) -> Distances:
    tuned, best = study.verdict.tuned, {told.name: told.events.value for told in study.detectors}
    return Distances(
        range_min=LidarSpec().range_min,
        default=study.verdict.default.value,
        tuned=None if tuned is None else tuned.value,
        clearance=best.get(alarms.FOOTPRINT_CLEARANCE),
    )


def _legend(study: RobotStudy, rover: RoverSpec, around: Distances) -> Iterator[Key]:
    ahead = f"{rover.lidar_x:.3f} m ahead of the middle, {rover.lidar_height:.3f} m up"
    untold = _untold(rover, (around.range_min, around.default))
    yield Key(f"footprint, {rover.length:.2f} {TIMES} {rover.width:.2f} m", "line", INK)
    yield Key(f"lidar, {ahead}", "circle", METRIC)
    yield Key(f"range_min {around.range_min:g} m", "line", MUTED, DASHES["dot"])
    yield Key(f"default collision_threshold {around.default:g} m", "line", INK, DASHES["dash"])
    yield Key(f"not told with the default: {untold}", "hatch", TRUTH)
    if around.tuned is not None:
        name, untold = chosen(study.collision.verdict), _untold(rover, (around.range_min, around.tuned))
        yield Key(f"{name} collision_threshold {around.tuned:g} m", "line", METRIC)
        yield Key(f"not told with that value: {untold}", "cross", METRIC)
    if around.clearance is not None:
        yield Key(f"best footprint clearance {around.clearance:g} m", "line", SCAN, DASHES["dashdot"])
    yield Key("below the plane of the lidar: never seen", "hatch", MUTED)


def _untold(rover: RoverSpec, told: Told) -> str:
    near, _, far = (f"{int(100 * share + 0.5)} %" for share in shares(rover, told))
    return f"{far} of the outline lies beyond it, {near} nearer than range_min"
