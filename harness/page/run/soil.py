"""What soil did to the wheels of a run: curves over time, and ruts on the map."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import cycle

from harness.page import figure as fig
from harness.page.run.recorder import Stretch
from harness.page.run.series import over_time
from harness.samples import SoilState

# By heading: unit, what it is, and its value for each wheel.
PANELS: Mapping[str, tuple[str, str, Callable[[SoilState], Sequence[float]]]] = {
    "Sinkage in soil": (
        "mm",
        "Depth of each wheel's lowest point below the ground without ruts (truth).",
        lambda soil: [1e3 * value for value in soil.sinkage],
    ),
    "Slip angle in soil": (
        "deg",
        "Between each wheel's plane and its way over the ground, positive to the left (truth).",
        lambda soil: [math.degrees(value) for value in soil.slip_angle],
    ),
    "Drawbar pull in soil": (
        "N",
        "Force of the soil on each wheel along its heading, negative where it holds back (truth).",
        lambda soil: soil.pull,
    ),
    "Side force in soil": (
        "N",
        "Force of the soil on each wheel to its left (truth).",
        lambda soil: soil.side_force,
    ),
}
RUTS = "ruts (truth)"
SCALE = {  # of depths [mm]
    "colorscale": "YlOrBr",
    "cmin": 0.0,
    "cmax": 40.0,
    "line": {"width": 0, "color": "--rock"},
}
STUCK = "stuck: wheels turn and do not get on (truth)"


def soil_plots(track: Sequence[Stretch], wheels: Sequence[str]) -> list[fig.Plot]:
    """Returns a plot of each quantity, a curve per wheel; none of a run on rigid ground."""
    known = [(stretch.time_s, stretch.soil) for stretch in track if stretch.soil is not None]
    if not known:
        return []
    times, states = zip(*known, strict=True)
    shapes = _stuck(known)
    plots = []
    for number, (heading, (unit, meaning, of)) in enumerate(PANELS.items()):
        values = list(zip(*map(of, states), strict=True))
        curves = [
            fig.line(wheel, times, curve, dash=dash, width=1.5, hover=f"{wheel} %{{y:.2f}}")
            for wheel, curve, dash in zip(wheels, values, cycle(fig.DASHES), strict=False)
        ]
        lowest, highest = min(map(min, values)), max(map(max, values))
        summary = f"{heading} over time: {lowest:.1f} to {highest:.1f} {unit}"
        drawn = {"data": curves, "layout": over_time(times[-1], unit, shapes)}
        plots.append(fig.Plot(f"soil-{number}", summary, drawn, heading, meaning))
    return plots


def ruts(track: Sequence[Stretch]) -> fig.Trace:
    """Returns where wheels pressed the ground down, the deeper the darker, as a trace of the map."""
    pressed = [rut for stretch in track if stretch.soil is not None for rut in stretch.soil.ruts]
    x, y, depths = zip(*pressed, strict=True) if pressed else ((), (), ())
    marker = {"size": 4, "color": fig.numbers([1e3 * depth for depth in depths], 1)} | SCALE
    return fig.points(RUTS, x, y, marker, "rut %{marker.color:.0f} mm")


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
