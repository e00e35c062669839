"""A page about runs among people: its pictures, and what they show."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rover_metrics.analysis.page import page
from rover_metrics.analysis.plots.style import MARKERS, WIDTH, look, say_that_nothing_is_there, shortened
from rover_metrics.analysis.social.comparison import METRICS, Group
from rover_metrics.analysis.social.metrics import PERSONAL_SPACE, ZONES
from rover_metrics.sheet.sheet import Sheet

FARTHEST = 6.0  # [m] on the axis of distances
LONGEST = 24  # letters of a group's name


def render(groups: Mapping[str, Group], sheets: Iterable[Sheet]) -> str:
    """Returns the HTML of a page."""
    near = f"Grey: the rover, each second; coloured: with somebody nearer than {PERSONAL_SPACE:g} m."
    pictures = (
        ("Windows", draw_windows, "Each point one window, in the order of time; line: mean."),
        ("Distances", draw_distances, "Dotted: the outer limits of Hall's zones."),
        ("Where they met", draw_meetings, near),
    )
    drawn = ((title, draw(groups), hint) for title, draw, hint in pictures)
    return page("Rover and people", f"Rover and people: {', '.join(groups)}", drawn, sheets)


def draw_windows(groups: Mapping[str, Group]) -> Figure:
    """Returns each window as a point, with the mean of each group, metric by metric."""
    figure = Figure(figsize=(WIDTH, 2.6), layout="constrained")
    names = [shortened(name, LONGEST) for name in groups]
    for panel, (metric, title) in enumerate(METRICS.items(), 1):
        axes = figure.add_subplot(1, len(METRICS), panel)
        for place, group in enumerate(groups.values()):
            values, colour = group.of_windows(metric), look(place)["color"]
            if not values.size:  # an empty curve leaves the others no room
                continue
            spread = np.linspace(-0.22, 0.22, values.size)  # in the order of time
            mark = MARKERS[place % len(MARKERS)]
            axes.plot(place + spread, values, mark, color=colour, alpha=0.7, markersize=4, clip_on=False)
            axes.hlines(float(values.mean()), place - 0.3, place + 0.3, color=colour, linewidth=2)
        axes.set_title(title, loc="left")
        if not any(group.of_windows(metric).size for group in groups.values()):
            say_that_nothing_is_there(axes)
            continue
        axes.set_xticks(range(len(names)), names)
        axes.set_xlim(-0.5, len(names) - 0.5)
        axes.set_ylim(bottom=0.0)
    return figure


def draw_distances(groups: Mapping[str, Group]) -> Figure:
    """Returns the share of seconds in which the nearest person was nearer, over the distance."""
    figure = Figure(figsize=(WIDTH, 2.8), layout="constrained")
    axes = figure.add_subplot()
    for number, (name, group) in enumerate(groups.items()):
        nearest = np.concatenate([log.nearest for log in group.logs])
        values = np.sort(nearest[np.isfinite(nearest)])
        share = 100 * np.arange(1, values.size + 1) / max(values.size, 1)
        axes.step(values, share, where="post", label=shortened(name, LONGEST), **look(number))
    at_top: dict[str, Any] = {"xycoords": ("data", "axes fraction"), "ha": "right", "va": "top"}
    for zone, limit in ZONES.items():
        axes.axvline(limit, color="#999999", linewidth=0.8, linestyle=":")
        axes.annotate(f" {zone} ", (limit, 1.0), fontsize=7.5, **at_top)
    axes.set(xlim=(0.0, FARTHEST), ylim=(0.0, 100.0), xlabel="distance to the nearest person [m]")
    axes.set_ylabel("seconds nearer than that [%]")
    axes.legend(loc="lower right")
    return figure


def draw_meetings(groups: Mapping[str, Group]) -> Figure:
    """Returns the places of the rover, and those where somebody was in its personal space."""
    columns = min(3, len(groups))
    lines = -(-len(groups) // columns)
    figure = Figure(figsize=(WIDTH, 0.4 + 2.6 * lines), layout="constrained")
    for number, (name, group) in enumerate(groups.items(), 1):
        axes = figure.add_subplot(lines, columns, number)
        x, y = np.concatenate([log.position for log in group.logs]).T
        near = np.concatenate([log.nearest for log in group.logs]) < PERSONAL_SPACE
        axes.plot(x, y, ".", color="#bbbbbb", markersize=2, rasterized=True)
        axes.plot(x[near], y[near], ".", color=look(1)["color"], markersize=4, rasterized=True)
        axes.set_title(shortened(name, LONGEST), loc="left")
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(xlabel="x [m]", ylabel="y [m]")
    return figure
