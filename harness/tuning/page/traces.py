"""Lines, bands and marks of the page's figures, and the axes that they stand on."""

from collections.abc import Iterable, Sequence
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike

from harness.page.figure import AXIS, INK, METRIC, MUTED, Figure, Layout, Trace, common_layout, numbers
from harness.tuning.scoring.result import Verdict

BAND, OTHER = "--band", "--scan"  # colours: of an interval, of the second kind of detector
DEFAULT_DASH, TUNED_DASH = "dot", "dash"
SHARE = {"range": [-0.02, 1.02]}  # of an axis from 0 to 1


def line(
    name: str,
    x: ArrayLike,
    y: ArrayLike,
    color: str = METRIC,
    *,
    dash: str = "solid",
    width: float = 2.0,
) -> Trace:
    """A curve."""
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": _numbers(x),
        "y": _numbers(y),
        "line": {"color": color, "width": width, "dash": dash},
        "hovertemplate": f"{name}<br>%{{x}}: %{{y:.3f}}<extra></extra>",
    }


def band(name: str, x: Sequence[float], low: Sequence[float], high: Sequence[float]) -> list[Trace]:
    """The area between two curves."""
    edge = {"line": {"width": 0, "color": BAND}, "hoverinfo": "skip"}
    lower = line("", x, low) | edge | {"showlegend": False}
    return [lower, line(name, x, high) | edge | {"fill": "tonexty", "fillcolor": BAND}]


def mark(name: str, x: float, y: float, color: str = INK, symbol: str = "circle") -> Trace:
    """A single point: an open symbol."""
    return {
        "type": "scatter",
        "mode": "markers",
        "cliponaxis": False,
        "name": name,
        "x": numbers([x], 4),
        "y": numbers([y], 4),
        "marker": {
            "symbol": symbol,
            "size": 11,
            "color": color if symbol.endswith("-open") else "--panel",
            "line": {"color": color, "width": 2.5},
        },
        "hovertemplate": f"{name}<br>%{{x:.3g}}: %{{y:.3f}}<extra></extra>",
    }


def level(name: str, x: float, dash: str, color: str = INK) -> Layout:
    """A line from bottom to top."""
    return {
        "type": "line",
        "yref": "paper",
        "x0": x,
        "x1": x,
        "y0": 0.0,
        "y1": 1.0,
        "line": {"color": color, "width": 1.5, "dash": dash},
        "name": name,
    }


def levels(verdict: Verdict) -> list[Layout]:
    """Where the default and the tuned value of a threshold lie."""
    default, tuned, unit = verdict.default.value, verdict.tuned, spelled(verdict.unit)
    lines = [level(f"default {default:g} {unit}", default, DEFAULT_DASH)]
    if tuned is not None:
        lines.append(level(f"{chosen(verdict)} {tuned.value:g} {unit}", tuned.value, TUNED_DASH))
    return lines


def figure(
    data: Iterable[Trace | list[Trace]],
    x: Layout,
    y: Layout,
    shapes: Iterable[Layout] = (),
) -> Figure:
    """A figure of traces over two axes, each with its title in brackets where it has a unit."""
    traces = chain.from_iterable([item] if isinstance(item, dict) else item for item in data)
    return {
        "data": list(traces),
        "layout": common_layout(
            xaxis=AXIS | x,
            yaxis=AXIS | y,
            shapes=list(shapes),
            margin={"l": 58, "r": 14, "t": 30, "b": 44},
            hovermode="closest",
        ),
    }


def titled(text: str, **values: object) -> Layout:
    """An axis with a title."""
    return {"title": {"text": text}, **values}


def chosen(verdict: Verdict) -> str:
    """What to call the value that was chosen: the parameter file has it only if it is proven."""
    return "chosen (not proven)" if verdict.value is None else "tuned"


def chance(name: str, x: Sequence[float], y: Sequence[float]) -> Trace:
    """What guessing gives."""
    return line(name, x, y, MUTED, dash="dot", width=1.0)


def spelled(unit: str) -> str:
    """A unit with a true exponent."""
    return unit.replace("^2", "²")


def _numbers(values: ArrayLike) -> list[float | None]:
    return numbers(np.asarray(values, dtype=np.float64).tolist(), 4)
