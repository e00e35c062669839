"""A table as text, and how numbers are written in one."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from html import escape
from typing import Any

NONE = "–"  # noqa: RUF001  # an en dash, which no minus sign looks like in a column of numbers


@dataclass(frozen=True)
class Sheet:
    """A table as text.

    Attributes:
        titles: Titles of the columns; the cells of the first column name the rows.
        rows: Cells of each row, one per title; a page also takes rows that end early, and cells that
            are HTML (with a method `__html__`).
        caption: How the numbers were computed.
        findings: What is odd about the data behind the numbers.
        spare: Titles of the columns that a narrow page does without.
        codes: Short name of each row, which a terminal shows before it; empty if there are none.
        file: Name of the table's file, without extension.
    """

    titles: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    title: str = ""
    caption: str = ""
    findings: tuple[str, ...] = ()
    spare: frozenset[str] = frozenset()
    codes: tuple[str, ...] = ()
    file: str = ""

    @classmethod
    def of(cls, records: Iterable[Mapping[str, str]], title: str = "", **about: Any) -> "Sheet":  # noqa: ANN401
        """Returns the table of rows, which are cells by title, all of the same titles in one order."""
        rows = list(records)
        titles = tuple(rows[0]) if rows else ()
        return cls(titles, tuple(tuple(row.values()) for row in rows), title, **about)

    def narrow(self) -> "Sheet":
        """Returns the table without its spare columns."""
        kept = [place for place, title in enumerate(self.titles) if title not in self.spare]
        rows = tuple(tuple(row[place] for place in kept) for row in self.rows)
        return replace(self, titles=tuple(self.titles[place] for place in kept), rows=rows)

    def __html__(self) -> str:
        """Returns an HTML table; a template that escapes text leaves it as it is."""
        titles = [_html(title) for title in self.titles]
        head = "".join(f'<th scope="col">{title}</th>' for title in titles)
        lines = []
        for name, *cells in self.rows:
            pairs = zip(titles[1:], map(_html, cells), strict=False)
            labelled = "".join(f'<td data-label="{title}">{cell}</td>' for title, cell in pairs)
            lines.append(f'<tr><th scope="row">{_html(name)}</th>{labelled}</tr>\n')
        stacked = ' class="stacked"' if len(titles) > 3 else ""
        return (
            f'<div class="scroll">\n<table{stacked}>\n<thead><tr>{head}</tr></thead>\n'
            f"<tbody>\n{''.join(lines)}</tbody>\n</table>\n</div>\n"
        )


def _html(cell: str) -> str:
    return str(cell.__html__()) if hasattr(cell, "__html__") else escape(cell)


def number(value: float | None) -> str:
    """Returns four significant digits, never in powers of ten."""
    if value is None:
        return NONE
    if value == 0:
        return "0"
    digits = 4 - len(str(int(abs(value)))) if abs(value) >= 1 else 4
    return f"{value:.{max(digits, 0)}f}"


def formatted(value: float | None, form: str) -> str:
    """Returns a value in a format of Python's, or a dash."""
    return NONE if value is None else format(value, form)


def probability(p: float | None) -> str:
    """Returns a p-value as papers print it."""
    return "<0.001" if p is not None and p < 0.001 else formatted(p, ".3f")


def interval_text(interval: tuple[float, float] | None) -> str:
    """Returns both ends of an interval."""
    return NONE if interval is None else f"{number(interval[0])} to {number(interval[1])}"


def spelled(unit: str) -> str:
    """Returns a unit, or a formula, with true exponents."""
    return unit.replace("^2", "²").replace("^3", "³")


def unbroken(text: str) -> str:
    """Returns a text that stays on one line of a page."""
    return text.replace(" ", "\N{NO-BREAK SPACE}")
