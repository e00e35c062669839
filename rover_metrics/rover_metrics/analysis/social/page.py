"""A page about runs among people: one HTML file with tables and pictures, nothing from the network."""

import io
import re
from collections.abc import Iterable, Mapping
from html import escape

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Text

from rover_metrics.analysis.plots.style import DPI, MARKERS, STYLE, WIDTH, look, shortened
from rover_metrics.analysis.social.comparison import METRICS, Group
from rover_metrics.analysis.social.metrics import PERSONAL_SPACE, ZONES
from rover_metrics.sheet.sheet import Sheet

FARTHEST = 6.0  # [m] on the axis of distances
LONGEST = 24  # letters of a group's name
CSS = """
:root { color-scheme: light; }
body { margin: 0 auto; padding: 1rem; max-width: 84rem; font: 1rem/1.45 system-ui, sans-serif;
  background: #f4f5f6; color: #1b1f24; }
section { margin-top: 1rem; padding: 0.75rem; overflow-x: auto; background: #fff;
  border: 1px solid #e3e7eb; border-radius: 0.5rem; }
h1 { margin: 0; font-size: 1.6rem; } h2 { margin: 0 0 0.5rem; font-size: 1.1rem; }
table { border-collapse: collapse; font-size: 0.875rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.15rem 0.6rem; border-bottom: 1px solid #e3e7eb; text-align: right; }
th { vertical-align: bottom; } tbody th { font-weight: 400; } td, tbody th { white-space: nowrap; }
th:first-child { text-align: left; }
.hint { margin: 0.5rem 0 0; color: #57606a; font-size: 0.875rem; }
svg { width: 100%; height: auto; }
"""
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def render(groups: Mapping[str, Group], sheets: Iterable[Sheet]) -> str:
    """Returns the HTML of a page."""
    pictures = (
        ("Windows", draw_windows, "Each point one window, in the order of time; line: mean."),
        ("Distances", draw_distances, "Dotted: the outer limits of Hall's zones."),
        (
            "Where they met",
            draw_meetings,
            f"Grey: the rover, each second; coloured: with somebody nearer than {PERSONAL_SPACE:g} m.",
        ),
    )
    with mpl.rc_context({**STYLE, "svg.hashsalt": "social"}):  # same logs, same bytes
        drawn = [
            f"<section><h2>{title}</h2>{_svg(draw(groups), title)}<p class=hint>{hint}</p></section>"
            for title, draw, hint in pictures
        ]
    return "\n".join(
        [
            "<!doctype html>",
            '<html lang="en"><head><meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>Rover and people</title><style>{CSS}</style></head><body>",
            f"<h1>Rover and people: {escape(', '.join(groups))}</h1><main>",
            *drawn,
            *map(_table, sheets),
            "</main></body></html>\n",
        ]
    )


def _svg(figure: Figure, title: str) -> str:
    for text in figure.findobj(Text):
        text.set_parse_math(False)  # a $ in the name of a group is a $
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", dpi=DPI, metadata={"Date": None})
    drawn = buffer.getvalue()
    body = drawn[drawn.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    return body.replace("<svg", f'<svg role="img" aria-label="{escape(title)}"', 1)


def _table(sheet: Sheet) -> str:
    odd = "".join(f"<p class=hint>odd: {escape(finding)}</p>" for finding in sheet.findings)
    caption = f"<p class=hint>{escape(sheet.caption)}</p>"
    return f"<section><h2>{escape(sheet.title)}</h2>{odd}{sheet.__html__()}{caption}</section>"


def draw_windows(groups: Mapping[str, Group]) -> Figure:
    """Returns each window as a point, with the mean of each group, metric by metric."""
    figure = Figure(figsize=(WIDTH, 2.6), layout="constrained")
    names = [shortened(name, LONGEST) for name in groups]
    for panel, (metric, title) in enumerate(METRICS.items(), 1):
        axes = figure.add_subplot(1, len(METRICS), panel)
        for place, group in enumerate(groups.values()):
            values, colour = group.of_windows(metric), look(place)["color"]
            spread = np.linspace(-0.22, 0.22, values.size)  # in the order of time
            mark = MARKERS[place % len(MARKERS)]
            axes.plot(place + spread, values, mark, color=colour, alpha=0.7, markersize=4, clip_on=False)
            if values.size:
                axes.hlines(float(values.mean()), place - 0.3, place + 0.3, color=colour, linewidth=2)
        axes.set_title(title, loc="left")
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
    for zone, limit in ZONES.items():
        axes.axvline(limit, color="#999999", linewidth=0.8, linestyle=":")
        axes.annotate(
            f" {zone} ",
            (limit, 1.0),
            xycoords=("data", "axes fraction"),
            ha="right",
            va="top",
            fontsize=7.5,
        )
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
