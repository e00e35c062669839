"""What soil did to the wheels of a run: curves over time, and ruts on the map."""

import math
from collections.abc import Callable, Sequence

from harness.page import figure as fig
from harness.report.recorder import Stretch
from harness.report.series import ABOVE_AXIS
from harness.samples import SoilState

# Heading, unit, what it is, and its value for each wheel.
PANELS: tuple[tuple[str, str, str, Callable[[SoilState], Sequence[float]]], ...] = (
    (
        "Sinkage in soil",
        "mm",
        "Depth of each wheel's lowest point below the ground without ruts (truth).",
        lambda soil: [1e3 * value for value in soil.sinkage],
    ),
    (
        "Slip angle in soil",
        "deg",
        "Between each wheel's plane and its way over the ground, positive to the left (truth).",
        lambda soil: [math.degrees(value) for value in soil.slip_angle],
    ),
    (
        "Drawbar pull in soil",
        "N",
        "Force of the soil on each wheel along its heading, negative where it holds back (truth).",
        lambda soil: soil.pull,
    ),
    (
        "Side force in soil",
        "N",
        "Force of the soil on each wheel to its left (truth).",
        lambda soil: soil.side_force,
    ),
)
RUTS = "ruts (truth)"
STUCK = "stuck: wheels turn and do not get on (truth)"


def soil_plots(track: Sequence[Stretch], wheels: Sequence[str]) -> list[fig.Plot]:
    """Returns a plot of each quantity, a curve a wheel; none of a run on rigid ground."""
    known = [(stretch.time_s, stretch.soil) for stretch in track if stretch.soil is not None]
    if not known:
        return []
    times, states = zip(*known, strict=True)
    shapes = _stuck(known)
    plots = []
    for number, (heading, unit, meaning, of) in enumerate(PANELS):
        values = list(zip(*map(of, states), strict=True))
        dashes = tuple(fig.DASHES)
        curves = [
            fig.line(wheel, times, curve, dash=dashes[i % 4], width=1.5, hover=f"{wheel} %{{y:.2f}}")
            for i, (wheel, curve) in enumerate(zip(wheels, values, strict=True))
        ]
        layout = fig.common_layout(
            xaxis=fig.titled("simulated time [s]", automargin=False, range=[0.0, round(times[-1], 2)]),
            yaxis=fig.AXIS | {"automargin": False},
            shapes=shapes,
            hovermode="x",
            title={"text": f"[{unit}]", **ABOVE_AXIS},
        )
        summary = (
            f"{heading} over time: {min(map(min, values)):.1f} to {max(map(max, values)):.1f} {unit}"
        )
        drawn = {"data": curves, "layout": layout}
        plots.append(fig.Plot(f"soil-{number}", summary, drawn, heading, meaning))
    return plots


def ruts(track: Sequence[Stretch]) -> fig.Trace:
    """Returns where wheels pressed the ground down, the deeper the darker, as a trace of the map."""
    pressed = [rut for stretch in track if stretch.soil is not None for rut in stretch.soil.ruts]
    x, y, depths = zip(*pressed, strict=True) if pressed else ((), (), ())
    deep = [1e3 * depth for depth in depths]
    marker = {
        "size": 4,
        "color": fig.numbers(deep, 1),
        "colorscale": "YlOrBr",
        "cmin": 0.0,
        "cmax": 40.0,
    }
    return {
        "type": "scatter",
        "mode": "markers",
        "name": RUTS,
        "x": fig.numbers(x),
        "y": fig.numbers(y),
        "marker": marker | {"line": {"width": 0, "color": "--rock"}},
        "hovertemplate": "rut %{marker.color:.0f} mm<extra></extra>",
    }


def _stuck(states: Sequence[tuple[float, SoilState]]) -> list[fig.Layout]:
    """A band over each time in which the rover was stuck."""
    bands: list[fig.Layout] = []
    before = False
    for time_s, soil in states:
        if soil.stuck and not before:
            look = {"layer": "below", "line": {"width": 0}, "fillcolor": "--truth-band"}
            bands.append({"type": "rect", "x0": time_s, **fig.COLUMN, "name": STUCK, **look})
        if soil.stuck:
            bands[-1]["x1"] = time_s
        before = soil.stuck
    return bands
