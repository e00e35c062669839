"""The page of a tuning: what the template shows of each robot."""

from collections.abc import Mapping, Sequence
from typing import Any

from harness.page.figure import Plot
from harness.page.shell import fill
from harness.robots import find_rover
from harness.tune.episodes.plan import Planned
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.page import tables
from harness.tune.page.contact_figures import contact_figures
from harness.tune.page.drawing import drawings
from harness.tune.page.sample_figures import ground_figures, scan_figures, steps_and_jumps
from harness.tune.page.subject import Subject
from harness.tune.scoring import alarms, clearance, estimate, ground
from harness.tune.scoring.ground import SIGNALS
from harness.tune.scoring.study import RobotStudy, conclusions, scored_records, unreachable
from rover_metrics.sheet.sheet import Sheet

NUMBERS = {  # of the method
    "gap": alarms.GAP,
    "rough": ground.ROUGH * 1e3,
    "horizon": clearance.HORIZON,
    "level": 100 * estimate.LEVEL,
    "resamples": estimate.RESAMPLES,
    "fewest": estimate.FEWEST_EPISODES,
}


def render(
    studies: Sequence[RobotStudy],
    records: Mapping[Planned, EpisodeRecord],
    command: str,
    files: Mapping[str, str],
) -> str:
    """Returns the HTML of a tuning's report; the same arguments give the same bytes.

    Args:
        studies: Robots in order.
        records: The episodes that they are made of.
        command: What makes the files.
        files: The text of each robot's parameter file, by its name.
    """
    drawn = drawings([(one.name, find_rover(one.robot), one.collision) for one in studies])
    robots: list[dict[str, Any]] = []
    for study, (above, side) in zip(studies, drawn, strict=True):
        items = _items(Subject(study, scored_records(study.robot, records)))
        about = {"name": study.name, "conclusions": [*conclusions(study)], "file": files[study.name]}
        about["unreachable"] = unreachable(study.collision)
        robots.append(about | {"items": items | {"above": above, "side": side}})
    plots = [item for robot in robots for item in robot["items"].values() if isinstance(item, Plot)]
    content = {
        "robots": robots,
        "signals": SIGNALS,
        "command": command,
        "numbers": NUMBERS,
    }
    return fill("tuning", content, "harness.tune.page", plots)


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
