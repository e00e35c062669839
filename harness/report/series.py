"""Time series of a metrics log: a figure for each column, with thresholds and what else is known."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from harness.page.figure import METRIC, TRUTH, Figure, Trace, numbers
from harness.report.columns import Column, describe
from harness.report.events import Event
from harness.report.log import Log
from harness.report.recorder import Stretch
from harness.report.series_layout import series_layout
from rover_metrics.core.thresholds import Thresholds

MOST_ROWS = 4000  # of a plot
BAND = "--band"
EVERY_SAMPLE = "all samples, as simulated"

Series = tuple[list[float], list[float]]  # times [s], values


def thinned(times: Sequence[float], values: Sequence[float], most: int = MOST_ROWS) -> Series:
    """At most so many points of a series, the smallest and the largest of each bucket among them."""
    if len(times) <= most:
        return list(times), list(values)
    # What is not finite becomes small, so that a gap stays a gap.
    finite = np.nan_to_num(np.asarray(values), nan=-np.inf, posinf=-np.inf)
    kept: set[int] = set()
    for bucket in np.array_split(np.arange(len(times)), most // 2):
        kept |= {int(bucket[finite[bucket].argmin()]), int(bucket[finite[bucket].argmax()])}
    return [times[i] for i in sorted(kept)], [values[i] for i in sorted(kept)]


def series_figure(
    name: str,
    log: Log,
    thresholds: Thresholds,
    track: Sequence[Stretch],
    contacts: Sequence[Event],
    gravity: float,
) -> Figure:
    """Draws one column over time.

    Args:
        name: Of the column.
        log: Where its values are.
        thresholds: Of the run.
        track: What was recorded beside the log.
        contacts: When the rover touched a hazard.
        gravity: Of the run [m/s^2].
    """
    column = describe(name)
    data = [*_below(name, track), _logged(name, column, log), *_above(name, track)]
    end_s = max([*log.time_s[-1:], *(stretch.time_s for stretch in track[-1:])], default=1.0)
    return {"data": data, "layout": series_layout(column, thresholds, contacts, end_s, gravity)}


def _logged(name: str, column: Column, log: Log) -> Trace:
    times, values = thinned(log.time_s, log.columns[name])
    unit = f" {column.unit}" if column.unit else ""
    return {
        **_line(times, values, "log", METRIC),
        "mode": "lines+markers" if len(times) < 3 else "lines",
        "line": {"color": METRIC, "width": 2, "shape": "hv" if column.is_flag else "linear"},
        "hovertemplate": f"%{{x:.2f}} s: %{{y}}{unit}<extra></extra>",
    }


def _below(name: str, track: Sequence[Stretch]) -> list[Trace]:
    """The range of all IMU samples, where the log has one of each second."""
    if name != "IMU Acceleration Magnitude":
        return []
    times = [stretch.time_s for stretch in track]
    low = _line(times, [stretch.lowest_acceleration for stretch in track], "", BAND)
    high = _line(times, [stretch.highest_acceleration for stretch in track], EVERY_SAMPLE, BAND)
    return [low | {"showlegend": False}, high | {"fill": "tonexty", "fillcolor": BAND}]


def _above(name: str, track: Sequence[Stretch]) -> list[Trace]:
    """The truth on the same axis, if there is one."""
    times = [stretch.time_s for stretch in track]
    match name:
        case "Distance Traveled":
            return [_truth(times, [stretch.path_length for stretch in track])]
        case "Current Velocity":
            return [_truth(times[1:], _speeds(track))]
    return []


def _truth(times: Sequence[float], values: Sequence[float]) -> Trace:
    hover = {"hovertemplate": "truth %{y:.3f}<extra></extra>"}
    line = {"line": {"color": TRUTH, "width": 1.5, "dash": "dot"}}
    return _line(times, values, "truth", TRUTH) | hover | line


def _speeds(track: Sequence[Stretch]) -> list[float]:
    """Mean true speed over each stretch but the first [m/s]."""
    return [
        (later.path_length - earlier.path_length) / max(later.time_s - earlier.time_s, 1e-9)
        for earlier, later in pairwise(track)
    ]


def _line(times: Sequence[float], values: Sequence[float], name: str, color: str) -> Trace:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": numbers(times, 2),
        "y": numbers(values, 4),
        "line": {"color": color, "width": 1},
        "hoverinfo": "skip",
    }
