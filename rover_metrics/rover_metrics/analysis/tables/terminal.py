"""Tables on a terminal."""

from collections.abc import Iterable, Iterator

from rich import box
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from rover_metrics.analysis.result import Result
from rover_metrics.analysis.tables.sheets import Sheet, sheets

_WIDE = 120  # columns of a terminal; a narrower one shows less, JSON everything


def report(result: Result, width: int) -> Iterator[RenderableType]:
    """Yields everything there is to read of a result, on a terminal of so many columns."""
    return show(sheets(result), width)


def show(tables: Iterable[Sheet], width: int) -> Iterator[RenderableType]:
    """Yields tables with their headings, on a terminal of so many columns."""
    for sheet in tables:
        yield Text(f"\n{sheet.title}", style="bold")
        for finding in sheet.odd:
            yield Text(f"  odd: {finding}", style="yellow")
        yield _table(sheet, narrow=width < _WIDE)
        if sheet.head == "Pair":
            yield Text(sheet.caption, style="dim")


def _table(sheet: Sheet, *, narrow: bool) -> Table:
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left", caption_style="dim", pad_edge=False)
    if sheet.head != "Pair":  # that table is narrower than its caption
        table.caption = sheet.caption
    table.add_column(sheet.head, min_width=12)
    titles = sheet.titles(narrow=narrow)
    for title in titles:
        table.add_column(Text(title), justify="right", no_wrap=True)
    for row in sheet.rows:
        name = Text.assemble((f"{row.code:<4}", "bold"), f" {row.name}") if row.code else Text(row.name)
        table.add_row(name, *(row.cells[title] for title in titles))
    return table
