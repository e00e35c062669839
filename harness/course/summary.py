"""Episodes summed up: means with 95 % intervals by seed, and two entries paired by seed."""

import math
from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import Field

from harness.course.result import EpisodeResult
from harness.spec.value import Value
from rover_metrics.analysis.statistics.summary import t_interval

CONFIDENCE, DECIMALS = 0.95, 6


class Mean(Value):
    """A mean over seeds with its 95 % interval by Student's t, None without a spread."""

    mean: float
    low: float | None = None
    high: float | None = None


class TrackSummary(Value):
    """A track as a receipt has it.

    Attributes:
        score: Of an episode.
        success: Share of the episodes in which all goals were reached by the rules.
        spl: Success weighted by path length.
        risk_s_per_goal: Time near hazards or people for each goal reached [s]; None without one.
        tilt_p95: Mean over the episodes of the 95th percentile of the tilt [rad].
        seconds: Mean time of the successes [s]; None without one.
    """

    score: Mean
    success: Mean
    spl: Mean
    risk_s_per_goal: float | None
    tilt_p95: float
    seconds: float | None
    episodes: Annotated[tuple[EpisodeResult, ...], Field(min_length=1)]


def mean_of(values: Sequence[float], least: float = 0.0) -> Mean:
    """Returns the mean of values, one per seed, `least` to 1, with its interval."""
    mean = math.fsum(values) / len(values)
    interval = t_interval(np.array(values), mean, CONFIDENCE)
    ends = (None, None) if interval is None else interval
    low, high = (end and round(min(max(end, least), 1.0), DECIMALS) for end in ends)
    return Mean(mean=round(mean, DECIMALS), low=low, high=high)


def difference(first: Sequence[EpisodeResult], second: Sequence[EpisodeResult]) -> Mean | None:
    """Returns the second's score less the first's, paired by episode; None for fewer than two."""
    scores = {(one.seed, one.world_hash): one.score for one in first}
    shared = [one.score - scores[key] for one in second if (key := (one.seed, one.world_hash)) in scores]
    return mean_of(shared, least=-1.0) if len(shared) > 1 else None


def summarise(episodes: Sequence[EpisodeResult]) -> TrackSummary:
    """Returns the summary of a track's episodes, which are in the order of their seeds."""
    goals = sum(one.goals for one in episodes)
    risk = math.fsum(one.risk_s for one in episodes)
    times = [one.time for one in episodes if one.is_success]
    return TrackSummary(
        score=mean_of([one.score for one in episodes]),
        success=mean_of([float(one.is_success) for one in episodes]),
        spl=mean_of([one.spl for one in episodes]),
        risk_s_per_goal=round(risk / goals, DECIMALS) if goals else None,
        tilt_p95=round(math.fsum(one.tilt_p95 for one in episodes) / len(episodes), DECIMALS),
        seconds=round(math.fsum(times) / len(times), DECIMALS) if times else None,
        episodes=tuple(episodes),
    )
