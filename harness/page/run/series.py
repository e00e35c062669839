"""Time series of a metrics log: a figure for each column, with its thresholds and the truth."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from harness.page import figure as fig
from harness.page.run.log import THRESHOLDS, WITH_GRAVITY, Event, Log, describe
from harness.page.run.recorder import Stretch
from rover_metrics.analysis.metric import FLAGS
from rover_metrics.core.thresholds import THRESHOLD_INFO, Thresholds
from rover_metrics.sheet.sheet import spelled

MOST_ROWS = 4000  # of a plot
ABOVE_AXIS = {"x": 0.0, "xref": "container", "yref": "paper", "y": 1.0, "yanchor": "bottom"} | {
    "font": {"size": 12},
    "pad": {"l": 4, "b": 6},
}
EVERY_SAMPLE = "all samples, as simulated"

Series = tuple[list[float], list[float]]  # times [s], values


def thinned(times: Sequence[float], values: Sequence[float], most: int = MOST_ROWS) -> Series:
    """Returns a series with the smallest and the largest value of each of its parts.

    Args:
        times: Of the series [s].
        values: At those times.
        most: Number of points left; a shorter series stays as it is.
    """
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
) -> fig.Figure:
    """Returns one column over time, beside what was recorded of the same run.

    Args:
        name: The column.
        log: Has it.
        thresholds: Drawn as levels where the column has one.
        track: Samples and truth of the run.
        contacts: With hazards, drawn as bands.
        gravity: What the IMU reads at rest [m/s^2].
    """
    unit = spelled(describe(name).unit)
    data = [*_samples(name, track), _logged(name, unit, log), *_truth(name, track)]
    end_s = max([*log.time_s[-1:], *(stretch.time_s for stretch in track[-1:])], default=1.0)
    shapes = [*map(_contact, contacts), *_levels(name, thresholds, gravity)]
    return {"data": data, "layout": over_time(end_s, unit, shapes, _range(name, log.columns[name]))}


def over_time(
    end_s: float, unit: str, shapes: Sequence[fig.Layout], values: fig.Layout | None = None
) -> fig.Layout:
    """Returns the layout of a plot over simulated time.

    Args:
        end_s: End of the axis of time [s].
        unit: Of the values.
        shapes: What is drawn beside the curves.
        values: How the axis of the values differs from others.
    """
    return fig.common_layout(
        # Fixed margins, so that the time axes of all plots are in line.
        xaxis=fig.titled("simulated time [s]", automargin=False, range=[0.0, round(end_s, 2)]),
        yaxis=fig.AXIS | {"automargin": False} | (values or {}),
        shapes=list(shapes),
        hovermode="x",
        # Above the axis: beside it, long numbers would run into it.
        title={"text": f"[{unit}]" if unit else "", **ABOVE_AXIS},
    )


def varies(figure: fig.Figure, values: Sequence[float]) -> bool:
    """Returns whether a column of the log, or what is drawn beside it, has more than one value."""
    drawn = {y for trace in figure["data"] for y in trace["y"] if y is not None}
    return len(drawn.union(value for value in values if not math.isnan(value))) > 1


def _logged(name: str, unit: str, log: Log) -> fig.Trace:
    times, values = thinned(log.time_s, log.columns[name])
    shape = "hv" if name in FLAGS else "linear"
    drawn = fig.line("log", times, values, shape=shape, hover=f"%{{x:.2f}} s: %{{y}} {unit}".rstrip())
    return drawn | {"mode": "lines+markers" if _has_lone_point(values) else "lines"}


def _has_lone_point(values: Sequence[float]) -> bool:
    """Whether a value has none beside it, so that a line does not show it."""
    there = [False, *map(math.isfinite, values), False]
    return any(
        here and not (before or after)
        for before, here, after in zip(there, there[1:], there[2:], strict=False)
    )


def _samples(name: str, track: Sequence[Stretch]) -> list[fig.Trace]:
    """The range of all IMU samples, where the log has one of each second."""
    if name != "IMU Acceleration Magnitude":
        return []
    ranges = [(s.time_s, s.lowest_acceleration, s.highest_acceleration) for s in track]
    return fig.band(EVERY_SAMPLE, *(zip(*ranges, strict=True) if ranges else ((), (), ())))


def _truth(name: str, track: Sequence[Stretch]) -> list[fig.Trace]:
    """The truth on the same axis, if there is one."""
    points = [(stretch.time_s, stretch.path_length) for stretch in track]
    if name == "Current Velocity":
        points = [(t, (x - x0) / max(t - t0, 1e-9)) for (t0, x0), (t, x) in pairwise(points)]
    elif name != "Distance Traveled":
        return []
    times, values = zip(*points, strict=True) if points else ((), ())
    return [fig.line("truth", times, values, fig.TRUTH, dash="dot", width=1.5, hover="truth %{y:.3f}")]


def _range(name: str, values: Sequence[float]) -> fig.Layout:
    if name in FLAGS:
        return {"range": [-0.1, 1.1], "tickvals": [0, 1]}
    from_zero = {} if name in WITH_GRAVITY else {"rangemode": "tozero"}
    is_count = all(value == round(value) for value in values if math.isfinite(value))
    # Else a count of 0 has ticks of 0.2.
    return from_zero | ({"autorangeoptions": {"include": [0, 4]}} if is_count else {})


def _levels(name: str, thresholds: Thresholds, gravity: float) -> list[fig.Layout]:
    values = {each: getattr(thresholds, each) for each in THRESHOLDS.get(name, ())}
    units = {each: spelled(THRESHOLD_INFO[each].unit) for each in values}
    drawn = zip(values.items(), ("dash", "dashdot"), strict=False)
    dashed = [(f"{each} = {value:g} {units[each]}", value, dash) for (each, value), dash in drawn]
    if name in WITH_GRAVITY:
        dashed.append((f"g = {gravity} m/s²", gravity, "dot"))
    across = {"xref": "paper", "x0": 0.0, "x1": 1.0}
    return [fig.level(text, {**across, "y0": value, "y1": value}, dash) for text, value, dash in dashed]


def _contact(event: Event) -> fig.Layout:
    """A band from bottom to top while the rover touched a hazard."""
    return {
        "type": "rect",
        "x0": event.start_s,
        "x1": event.end_s,
        **fig.COLUMN,
        "name": "contact with a hazard (truth)",
        "layer": "below",
        "line": {"width": 0.5, "color": fig.TRUTH},
        "fillcolor": "--truth-band",
    }
