"""A run of eight seconds, made by hand: what it came to, its log, and what was recorded of it."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.episode.result import RunResult, TopicCount
from harness.episode.truth_account import TruthAlong
from harness.page.run.recorder import Approach, RunRecorder, Stretch
from harness.samples import ContactEvent, LaserScan, PlacedScan, Pose, Truth
from harness.spec.run import Run
from rover_metrics.core.columns import COLUMNS
from rover_metrics.core.thresholds import Thresholds

TOUCH = ContactEvent(
    "hazard", 1_500_000_000, 1_750_000_000, "chassis", "hazard_3", 41.6, (0.2, 0.1, 0.0)
)
TRUTH = Truth(
    time_ns=8_000_000_000,
    path_length=8.0,
    hazard_contacts=2,
    rock_contacts=5,
    scrapes=7,
    hazard_contact_s=0.25,
    rock_contact_s=1.5,
    scrape_s=0.75,
    mean_slip=0.129,
    largest_tilt=math.radians(30.4),
)
RESULT = RunResult(
    run=Run.of(terrain="posts", actors=("ann=1,1", "bob=2,2/2,3"), start=(-1.0, 0.5, 0.3)),
    mode="direct",
    truth=TRUTH,
    wall_s=4.0,
    rows=8,
    topics={"/scan": TopicCount(12_000, 11_990, 10), "/tf": TopicCount(7)},
    thresholds=Thresholds(collision_threshold=0.3),
    last_row={"Distance Traveled": 8.2, "Total Collisions": 6},
    along=TruthAlong(
        events=(TOUCH, replace(TOUCH, kind="rock"), replace(TOUCH, kind="scrape")), event_count=2000
    ),
)
ROW: dict[str, object] = {  # of a log, by columns that do not stay as they are in `write_log`
    "Current Smoothness": 10.0,
    "Is Rough Terrain": 0,
    "Vertical Roughness": 9.8,
    "Notes": "Normal operation",
}


def stretches(*changes: dict[str, Any]) -> list[Stretch]:
    """A drive along x at 1 m/s, a stretch a second."""
    return [
        Stretch(float(i + 1), (float(i + 1), 0.0, 0.0), float(i + 1), **values)
        for i, values in enumerate(changes)
    ]


def write_log(path: Path) -> Path:
    """Writes a log with eight rows, and two columns that the data dictionary does not know."""
    lines = [",".join([*COLUMNS[:-1], "Wheel Heat [K]", "VORT [m/s]", "Notes"])]
    for i in range(8):
        cells: dict[str, object] = {
            "Timestamp": i + 1.0,
            "Total Collisions": 3 * (i > 4),
            "Current Collision Status": int(i == 5),
            "Smoothness Metric": 200.0 * i,
            "Obstacle Clearance": "inf" if i < 2 else 1.5 + 0.1 * i,
            "Distance Traveled": 1.025 * (i + 1),
            "Current Velocity": 0.9 + 0.05 * (i % 3),
            "IMU Acceleration Magnitude": 9.8 + i % 2,
            "Wheel Heat [K]": 300 + i,
            "VORT [m/s]": 0.25 if i in (1, 2) else "",
        }
        cells = cells | ROW | {"Is Rough Terrain": int(i == 3)}
        lines.append(",".join(str(cells[name]) for name in lines[0].split(",")))
    path.write_text("\n".join(lines) + "\n")
    return path


def recorder() -> RunRecorder:
    """What was recorded: contacts, a near miss, two people, one of whom comes near."""
    shaken = {"lowest_acceleration": 6.8, "highest_acceleration": 13.3, "contact_s": 0.2}
    calm = {"lowest_acceleration": 9.7, "highest_acceleration": 10.0, "nearest_range": 1.0}
    people = [
        {
            "people": ((1.0, 1.0, 0.9), (2.0, 2.0 + i / 10, 0.9)),
            "approaches": (
                Approach(4.0 - i / 4, i + 1.0, (i + 1.0, 0.0), (1.0, 1.0)),
                Approach(abs(i - 5) + 0.5, i + 1.0, (i + 1.0, 0.0), (2.0, -2.0 + i / 10)),
            ),
        }
        for i in range(8)
    ]
    changes = [calm, shaken, shaken, calm, calm | {"nearest_range": 0.2}, {}, calm, calm]
    made = RunRecorder()
    made.track = stretches(*(change | near for change, near in zip(changes, people, strict=True)))
    ranges = np.full(640, np.inf, np.float32)
    ranges[[0, 160, 320]] = 2.0
    made.last_scan = PlacedScan(
        LaserScan(8_000_000_000, ranges), Pose(8_000_000_000, (8.0, 0.0, 0.1), (0.0, 0.0, 0.0, 1.0))
    )
    return made
