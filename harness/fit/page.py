"""What a fit came to, as tables and as a page."""

from math import isfinite

import numpy as np

from harness.fit.estimate import Estimate
from harness.fit.ground import UNITS
from harness.fit.outcome import Outcome
from harness.fit.steady import TURNING
from harness.page.figure import INK, METRIC, SCAN, Plot, common_layout, line, titled
from harness.page.shell import fill
from harness.validate.replay import controlled
from rover_metrics.sheet.sheet import NONE, Sheet

DIFFERENCES = "Ours less the recorded, root mean square"
SHOWN, POINTS = 40.0, 1000  # [s] of the sides' speeds, and points of a line
WITHIN = 0.15  # of a step's length: harness.validate's limit


def tables(outcome: Outcome) -> list[Sheet]:
    """Returns what was found, what is left of the differences, and what is not known and why."""
    known = [one for one in outcome.estimates if one.is_known]
    rows = [
        (one.name, one.unit, one.key or NONE, *map(_number, (one.before, one.after)), _interval(one))
        for one in known
    ]
    left = [(*named, *map(_number, pair)) for named, pair in outcome.residuals.items()]
    left_out = outcome.held[0].size
    if left_out:
        steps = f"ends of {outcome.held[0].size} held-back steps"
        error = [_number(float(np.median(ends))) for ends in outcome.held]
        within = [f"{np.mean(ends <= WITHIN):.0%}" for ends in outcome.held]
        left += [(f"{steps}, median error / length", "", *error)]
        left += [(f"{steps} within {WITHIN:.0%}", "", *within)]
    titles = "parameter", "unit", "rover.yaml", "before", "after", "95 %"
    unknown = [{"parameter": one.name, "why": one.why} for one in outcome.estimates if not one.is_known]
    turns = f"Turns: sides that differ by more than {TURNING:g} m/s."
    caption = f"{turns} Of the last third, which is held back, nothing counts." if left_out else turns
    sheets = [
        Sheet(titles, tuple(rows), "Parameters"),
        Sheet(("quantity", "unit", "before", "after"), tuple(left), DIFFERENCES),
        Sheet.of(unknown, "What the recording does not tell", caption=caption),
    ]
    return [sheet for sheet in sheets if sheet.rows]


def _interval(one: Estimate) -> str:
    return f"{_number(one.after - one.half)} to {_number(one.after + one.half)}"


def _number(value: float) -> str:
    return f"{value:.4g}" if isfinite(value) else NONE


def render(outcome: Outcome, source: str) -> str:
    """Returns the HTML; the same fit gives the same bytes."""
    plots = [*_sides(outcome), *_steady(outcome)]
    content = {"name": outcome.rover.name, "source": source, "tables": tables(outcome), "plots": plots}
    return fill("fit", content, "harness.fit", plots)


def _sides(outcome: Outcome) -> list[Plot]:
    """The speeds of both sides, as recorded and as the controllers before and after want them."""
    recording = outcome.recording
    drawn = (
        ("recorded", recording.wheels, INK),
        ("before", controlled(outcome.rover, recording), SCAN),
        ("after", controlled(outcome.fitted, recording), METRIC),
    )
    plots = []
    for column, side in ((1, "left"), (2, "right")):
        lines = []
        for name, series, color in drawn:
            part = series[(series[:, 0] >= 0.0) & (series[:, 0] <= SHOWN)]
            part = part[:: max(1, len(part) // POINTS)]
            lines.append(line(name, part[:, 0], part[:, column], color, shape="hv", width=1.5))
        layout = common_layout(xaxis=titled("time [s]"), yaxis=titled("speed [m/s]"))
        title = f"Speed of the {side} side"
        plots.append(Plot(f"side-{side}", title, {"data": lines, "layout": layout}, title))
    return plots


def _steady(outcome: Outcome) -> list[Plot]:
    """A plot of ours over the recorded, a mark for each kind of steady driving."""
    plots = []
    for name, unit in UNITS.items():
        real, title = getattr(outcome.like, name), f"{name.replace('_', ' ')} [{unit}]"
        known = np.isfinite(real)
        if not known.any():
            continue
        ends = [float(real[known].min()), float(real[known].max())]
        data = [line("as recorded", ends, ends, INK, dash="dash", width=1)]
        for label, ours, color in zip(("before", "after"), outcome.ours, (SCAN, METRIC), strict=True):
            marker = {"color": color, "size": 8, "symbol": "circle"}
            marks = line(label, real[known], getattr(ours, name)[known], color)
            data.append(marks | {"mode": "markers", "marker": marker})
        layout = common_layout(xaxis=titled(f"recorded {title}"), yaxis=titled("ours"))
        plots.append(Plot(f"steady-{name}", title, {"data": data, "layout": layout}, f"Steady: {title}"))
    return plots
