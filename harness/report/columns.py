"""How each column of the metrics log is drawn: its unit, its thresholds, what it means."""

import re
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Column:
    """How a column of the log is drawn.

    Attributes:
        meaning: The caption.
        unit: Of its values; empty for a number without one.
        thresholds: Names of the thresholds that its values are compared with.
        is_flag: Whether it is 0 or 1.
        shows_gravity: Whether gravity is in its values.
    """

    meaning: str
    unit: str = ""
    thresholds: tuple[str, ...] = ()
    is_flag: bool = False
    shows_gravity: bool = False


KNOWN_COLUMNS = {
    "Total Collisions": Column(
        meaning="Scans so far whose nearest range was below collision_threshold.", unit="scans"
    ),
    "Current Collision Status": Column(
        meaning="1 while the windowed clearance is below collision_threshold.", is_flag=True
    ),
    "Smoothness Metric": Column(
        meaning="Sum of |a| + |ω| over all IMU samples so far.", unit="m/s² + rad/s"
    ),
    "Current Smoothness": Column(
        meaning="Mean of |a| + |ω| over the last 100 IMU samples.",
        unit="m/s² + rad/s",
        thresholds=("smoothness_threshold",),
    ),
    "Obstacle Clearance": Column(
        meaning="Mean of the last 100 nearest ranges; a gap where nothing was ever in range (inf).",
        unit="m",
        thresholds=("collision_threshold", "min_safe_clearance"),
    ),
    "Distance Traveled": Column(
        meaning="Path length so far, steps of distance_threshold or more left out.", unit="m"
    ),
    "Current Velocity": Column(meaning="Mean of the last 100 wheel odometry speeds.", unit="m/s"),
    "IMU Acceleration Magnitude": Column(
        meaning="|a| of the latest IMU sample of each second, gravity included.",
        unit="m/s²",
        thresholds=("rough_terrain_threshold",),
        shows_gravity=True,
    ),
    "Is Rough Terrain": Column(
        meaning="1 if |a| of that sample is above rough_terrain_threshold.", is_flag=True
    ),
    "Vertical Roughness": Column(
        meaning="|az| of the latest IMU sample of each second, gravity included.",
        unit="m/s²",
        shows_gravity=True,
    ),
}


def describe(name: str) -> Column:
    """Returns what is known of a column; an unknown one has the unit in its name's brackets."""
    unit = re.search(r"\[(.+)\]$", name)
    unknown = Column(meaning="A column beyond RoboTerrain's twelve.", unit=unit[1] if unit else "")
    return KNOWN_COLUMNS.get(name, unknown)
