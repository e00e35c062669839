"""How the page is laid out: sections of rows, in each of which the robots stand side by side."""

from dataclasses import dataclass

from markupsafe import Markup

from harness.page.figure import Key, Plot


@dataclass(frozen=True)
class Table:
    """Text in rows; the first cell of each names it, and a row may end early."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Drawing:
    """Pictures to one scale, with their key."""

    pictures: tuple[Markup, ...]
    legend: tuple[Key, ...]


@dataclass(frozen=True)
class Cell:
    """What a row says of one robot.

    Attributes:
        content: A text says why there is nothing to show.
        note: Stands below it.
    """

    robot: str
    content: Plot | Table | Drawing | str
    note: str = ""

    @property
    def kind(self) -> str:
        """How the template shows it."""
        return type(self.content).__name__


@dataclass(frozen=True)
class Row:
    """One matter, for all robots.

    Attributes:
        wide: The robots stand below, not beside each other.
        folded: Only its heading shows at first.
    """

    heading: str
    caption: str
    cells: tuple[Cell, ...]
    wide: bool = False
    folded: bool = False


@dataclass(frozen=True)
class Section:
    """A part of the page."""

    name: str
    heading: str
    intro: str
    rows: tuple[Row, ...]
