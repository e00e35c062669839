"""The result of an analysis of one log of one metric, for what shows it."""

from rover_metrics.analysis.outcome import LogResult, Result
from rover_metrics.analysis.statistics.summary import Summary

SPEED = Summary(60, 0.52, 21.4, 0.51, 0.08, 0.12, 0.93, (0.5, 0.54), (0.47, 0.57), 4)
LOG = LogResult("[b]x", "x.csv", "all logs", 60, 59.0, 1, (), {"CV": SPEED}, {"CV": 1.75}, {"CV": 3}, ())
RESULT = Result(
    0.9,
    outliers_removed=False,
    iqr_multiplier=2.5,
    unit="log",
    groups=("all logs",),
    logs=(LOG,),
    across={},
    correlations=(),
)
