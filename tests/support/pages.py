"""What stands on an HTML page: its headings and tags, and whether each tag is closed."""

from html.parser import HTMLParser
from importlib.resources import files


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
