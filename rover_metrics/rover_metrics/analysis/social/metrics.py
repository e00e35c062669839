"""What a run among people comes to, and its windows of so many goals, by RoboTerrain's rules.

A row stands for a second. Risk is a second in which somebody is nearer than `RISK_DISTANCE`. A window
ends with the row in which its last goal was reached and begins behind the one before; what comes after
the last whole window is in none. The logs of a group are joined before they are cut, so that a
window may reach from one into the next, as RoboTerrain's published figures have it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.social.log import SocialLog

RISK_DISTANCE = 0.5  # [m]
WINDOW_GOALS = 10
# Hall, The Hidden Dimension (1966): outer limits of his zones [m]; beyond the last is the public one.
ZONES = {"intimate": 0.45, "personal": 1.2, "social": 3.6}
PERSONAL_SPACE = ZONES["personal"]
SOON = 3.0  # [s] within which people act on a collision to come (Karamouzas, Skinner & Guy 2014)
FASTEST = 5.0  # [m/s]: a faster approach is a respawn


@dataclass(frozen=True)
class RunFigures:
    """What one log comes to."""

    seconds: int  # its rows
    goals: int  # reached in it
    risk_s: int  # seconds with somebody nearer than the risk distance
    min_distance: float | None  # smallest to anybody [m]; None if none is known
    zone_s: dict[str, int]  # seconds with the nearest person in each of Hall's zones
    intrusions: int  # times that a person came into, or was first seen in, the personal space
    min_time_to_collision: float | None  # distance over closing speed [s]; None if nobody came nearer
    closing_s: int  # seconds with a time to collision of less than SOON, to anybody
    risk_s_per_goal: float | None  # None without a goal, as the next
    s_per_goal: float | None


def run_figures(log: SocialLog, risk_distance: float = RISK_DISTANCE) -> RunFigures:
    """Returns what a log comes to; a distance below `risk_distance` [m] is a risk."""
    collision_s = times_to_collision(log)
    goals, risk_s = max(0, int(log.goals[-1] - log.goals[0])), int((log.nearest < risk_distance).sum())
    return RunFigures(
        seconds=len(log),
        goals=goals,
        risk_s=risk_s,
        min_distance=_smallest(log.nearest),
        zone_s=_zones(log.nearest),
        intrusions=_intrusions(log.distance),
        min_time_to_collision=_smallest(collision_s),
        closing_s=int((collision_s < SOON).any(axis=1).sum()),
        risk_s_per_goal=risk_s / goals if goals else None,
        s_per_goal=len(log) / goals if goals else None,
    )


def times_to_collision(log: SocialLog) -> Floats:
    """Returns, for each row after the first and each person, distance over closing speed [s].

    The closing speed is that of the distance between the centres since the row before; infinite where
    they do not come nearer, where no time passed, or where the rover was put elsewhere.

    Returns:
        Shape (rows - 1, people).
    """
    passed = np.diff(log.time_s)[:, None]
    closed = -np.diff(log.distance, axis=0)
    closing = np.divide(closed, passed, out=np.zeros_like(closed), where=passed > 0.0)
    approaches = (closing > 0.0) & (closing <= FASTEST)
    return np.divide(log.distance[1:], closing, out=np.full_like(closing, np.inf), where=approaches)


def windows(
    logs: Sequence[SocialLog], goals: int = WINDOW_GOALS, risk_distance: float = RISK_DISTANCE
) -> Floats:
    """Returns risk seconds for a goal and seconds for a goal of each window of a group.

    A row in which the count of goals rises ends one goal, whatever it rises by.

    Args:
        logs: The group's, in their order.
        goals: Of a window.
        risk_distance: Below which a distance is a risk [m].

    Returns:
        Shape (windows, 2); no rows where there are too few goals.
    """
    if not logs:
        return np.empty((0, 2))
    reached = np.concatenate([log.goals for log in logs])
    risky = np.concatenate([log.nearest < risk_distance for log in logs])
    ends = np.flatnonzero(np.diff(reached, prepend=reached[0]) > 0)[goals - 1 :: goals] + 1
    starts = np.array([0, *ends[:-1]])[: ends.size]
    pieces = zip(starts.tolist(), ends.tolist(), strict=True)
    return np.array([(risky[a:b].sum() / goals, (b - a) / goals) for a, b in pieces]).reshape(-1, 2)


def _smallest(values: Floats) -> float | None:
    finite = values[np.isfinite(values)]
    return float(finite.min()) if finite.size else None


def _zones(nearest: Floats) -> dict[str, int]:
    known = nearest[np.isfinite(nearest)]
    places = np.searchsorted(list(ZONES.values()), known, side="right")
    counts = np.bincount(places, minlength=len(ZONES) + 1)
    return dict(zip((*ZONES, "public"), counts.tolist(), strict=True))


def _intrusions(distance: Floats) -> int:
    """Returns how often a person is inside who was outside in the last row with a distance."""
    entered = 0
    for person in distance.T:
        inside = person[np.isfinite(person)] < PERSONAL_SPACE
        entered += int((np.diff(inside.astype(np.int8), prepend=0) > 0).sum())
    return entered
