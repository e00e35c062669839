"""A page about logs: one HTML file with tables and pictures, nothing from the network."""

import io
import re
from collections.abc import Iterable
from html import escape

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.text import Text

from rover_metrics.analysis.plots.style import DPI, STYLE
from rover_metrics.sheet.sheet import Sheet

CSS = """
:root { color-scheme: light dark; }
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
h1, h2 { overflow-wrap: anywhere; }
@media screen and (prefers-color-scheme: dark) {
  body { background: #0d1117; color: #e6edf3; } section { background: #171717; }
  section, th, td { border-color: #30363d; } .hint { color: #9ea7b3; }
  svg { filter: invert(0.91) hue-rotate(180deg); }
}
"""
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def page(
    title: str, heading: str, pictures: Iterable[tuple[str, Figure, str]], sheets: Iterable[Sheet]
) -> str:
    """Returns the HTML of a page.

    Args:
        title: Of the window.
        heading: On top of the page.
        pictures: Each with its title and what it shows; drawn as they are asked for.
        sheets: The tables below.
    """
    with mpl.rc_context({**STYLE, "svg.hashsalt": "social"}):  # same logs, same bytes
        drawn = [
            f"<section><h2>{escape(name)}</h2>{_svg(figure, name)}<p class=hint>{hint}</p></section>"
            for name, figure, hint in pictures
        ]
    return "\n".join(
        [
            "<!doctype html>",
            '<html lang="en"><head><meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(title)}</title><style>{CSS}</style></head><body>",
            f"<h1>{escape(heading)}</h1><main>",
            *drawn,
            *map(_section, sheets),
            "</main></body></html>\n",
        ]
    )


def _svg(figure: Figure, title: str) -> str:
    for text in figure.findobj(Text):
        text.set_parse_math(False)  # a $ in the name of a group is a $
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", dpi=DPI, metadata={"Date": None})
    _, tag, body = buffer.getvalue().partition("<svg")
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    return f'{tag} role="img" aria-label="{escape(title)}"{body}'


def _section(sheet: Sheet) -> str:
    odd = "".join(f"<p class=hint>odd: {escape(finding)}</p>" for finding in sheet.findings)
    caption = f"<p class=hint>{escape(sheet.caption)}</p>"
    return f"<section><h2>{escape(sheet.title)}</h2>{odd}{sheet.__html__()}{caption}</section>"
