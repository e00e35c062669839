"""What stands around and behind a time series: axes, thresholds, contacts."""

from collections.abc import Sequence

from harness.page.figure import AXIS, INK, TRUTH, Layout, common_layout
from harness.report.columns import Column
from harness.report.events import Event
from rover_metrics.core.thresholds import THRESHOLD_INFO, Thresholds


def series_layout(
    column: Column, thresholds: Thresholds, contacts: Sequence[Event], end_s: float, gravity: float
) -> Layout:
    """Returns the layout of a column's plot.

    Args:
        column: What is drawn.
        thresholds: Of the run.
        contacts: When the rover touched a hazard.
        end_s: End of the run [s]; it starts at 0.
        gravity: Of the run [m/s^2].
    """
    fixed = AXIS | {"automargin": False}  # so that the time axes of all plots are in line
    y_axis = fixed | {"title": {"text": f"[{column.unit}]" if column.unit else ""}}
    if column.is_flag:
        y_axis |= {"range": [-0.1, 1.1], "tickvals": [0, 1]}
    elif not column.shows_gravity:
        y_axis |= {"rangemode": "tozero"}
    if column.unit == "scans":
        y_axis |= {"autorangeoptions": {"include": [0, 4]}}  # else a count of 0 has ticks of 0.2
    lines = [
        _threshold(name, getattr(thresholds, name), dash)
        for name, dash in zip(column.thresholds, ("dash", "dashdot"), strict=False)
    ]
    if column.shows_gravity:
        lines.append(_level(gravity, f"g = {gravity:g} m/s²", "dot"))
    return common_layout(
        xaxis=fixed | {"title": {"text": "simulated time [s]"}, "range": [0.0, round(end_s, 2)]},
        yaxis=y_axis,
        shapes=[*(_contact(event) for event in contacts), *lines],
        margin={"l": 60, "r": 14, "t": 30, "b": 44},
        hovermode="x",
    )


def _threshold(name: str, value: float, dash: str) -> Layout:
    unit = THRESHOLD_INFO[name].unit.replace("^2", "²")
    return _level(value, f"{name} = {value:g} {unit}", dash)


def _level(value: float, name: str, dash: str) -> Layout:
    """A horizontal line; beside it, its name would cover the curve, so the legend has it."""
    return {
        "type": "line",
        "xref": "paper",
        "x0": 0.0,
        "x1": 1.0,
        "y0": value,
        "y1": value,
        "line": {"color": INK, "width": 1.5, "dash": dash},
        "name": name,
    }


def _contact(event: Event) -> Layout:
    """A band from bottom to top while the rover touched a hazard."""
    return {
        "type": "rect",
        "yref": "paper",
        "x0": event.start_s,
        "x1": event.end_s,
        "y0": 0.0,
        "y1": 1.0,
        "name": "contact with a hazard (truth)",
        "layer": "below",
        "line": {"width": 0.5, "color": TRUTH},
        "fillcolor": "--truth-band",
    }
