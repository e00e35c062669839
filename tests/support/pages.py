"""What stands on an HTML page: its headings and tags, and whether each tag is closed."""

import json
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from importlib.resources import files
from typing import Any

from harness.base.version import __version__
from harness.page.figure import AXIS


class Outline(HTMLParser):
    """The outline of a page.

    Attributes:
        tags: Each tag with its attributes.
        headings: The title and the headings as (tag, text).
        open: Tags that are not closed.
    """

    VOID = ("meta", "link")

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.headings: list[tuple[str, str]] = []
        self.open: list[str] = []
        self.feed(page)

    @property
    def levels(self) -> list[int]:
        """The levels of the headings."""
        return [int(tag[1]) for tag, _ in self.headings if tag != "title"]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("title", "h1", "h2", "h3", "h4"):
            self.headings.append((self.open[-1], data))


def without_plotly(page: str) -> str:
    """Returns a page without the bundle of plotly."""
    bundle = files("harness.page").joinpath("assets", "plotly-basic.min.js")
    return page.replace(bundle.read_text(encoding="utf-8"), "")


def described_page(page: str) -> str:
    """Returns what a page with figures shows as text: its HTML, then a line a trace, axis and shape."""
    page = without_plotly(page)
    assert Outline(page).open == []
    assert not re.search(r"https?://|(src|href)=\"(?!data:|#)", page)
    assert all(f'id="{target}"' in page for target in re.findall(r'href="#([^"]+)"', page))
    (figures,) = re.findall(r'id="figures">(.*?)</script>', page)
    lines = (f"{name}: {line}\n" for name, one in json.loads(figures).items() for line in _drawn(one))
    html = re.sub(r"<(script|style).*?</\1>|<meta.*?>", "", page, flags=re.DOTALL)
    return html.replace(__version__, "VERSION") + "".join(lines)


def _drawn(figure: dict[str, Any]) -> Iterator[str]:
    layout = figure["layout"]
    axes = (layout[name] for name in ("xaxis", "yaxis") if name in layout)
    for item in (*figure["data"], *axes, *layout.get("shapes", ())):
        own = {name: value for name, value in item.items() if AXIS.get(name, ...) != value}
        yield json.dumps(_short(own), ensure_ascii=False)


def _short(value: object) -> object:
    """A value whose long lists are cut to ends and extremes, numbers to four digits."""
    if isinstance(value, dict):
        return {name: _short(item) for name, item in value.items()}
    if isinstance(value, float):
        return float(f"{value:.4g}")
    if not isinstance(value, list):
        return value
    known = [item for item in value if isinstance(item, int | float)]
    if len(value) <= 16 or not known:
        return [_short(item) for item in value]
    ends = (value[0], value[-1], min(known), max(known), sum(map(abs, known)))
    return f"{len(value)} numbers: " + " ".join(str(_short(end)) for end in ends)
