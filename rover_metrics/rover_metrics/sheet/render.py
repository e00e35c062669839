"""A table for a terminal, for LaTeX (booktabs) and for Markdown; records for CSV."""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rover_metrics.log.csv_log import harmless
from rover_metrics.sheet.sheet import Sheet

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

WIDE = 120  # columns of a terminal; a narrower one shows no spare columns
_SPECIAL = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    **{letter: f"\\{letter}" for letter in "&%$#_{}"},
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "²": r"\textsuperscript{2}",
    "³": r"\textsuperscript{3}",
    "–": "--",  # noqa: RUF001  # an en dash
}
_SIGN = re.compile(r"(?<![\w.])([+-])(?=\d)")
_CONTROL = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]")


def harmless_text(text: str) -> str:
    """Returns a text with a ? for each control character but a new line: none reaches a terminal."""
    return _CONTROL.sub("?", text)


def terminal(sheets: Iterable[Sheet], width: int, wide: int = WIDE) -> Iterator["RenderableType"]:
    """Yields tables with headings and findings, for a PlainConsole.

    Args:
        sheets: The tables.
        width: Of the terminal, in characters.
        wide: From this width on spare columns are shown.
    """
    from rich.text import Text  # noqa: PLC0415 - what makes documents and pages does without rich

    for sheet in sheets:
        yield Text(harmless_text(f"\n{sheet.title}"), style="bold")
        for finding in sheet.findings:
            yield Text(harmless_text(f"  odd: {finding}"), style="yellow")
        yield _table(sheet if width >= wide else sheet.narrow())
        if sheet.caption:  # not the table's own: that is cut where a table is wider than the terminal
            yield Text(harmless_text(sheet.caption), style="dim")


def _table(sheet: Sheet) -> "Table":
    from rich import box  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, title in enumerate(sheet.titles):
        if place:
            table.add_column(title, justify="right", no_wrap=True)
        else:
            table.add_column(title, min_width=12)
    codes = sheet.codes or ("",) * len(sheet.rows)
    for code, row in zip(codes, sheet.rows, strict=True):
        name, *cells = map(str, row)
        coded = Text.assemble((f"{code:<4}", "bold"), f" {harmless_text(name)}") if code else name
        table.add_row(coded, *cells)
    return table


def markdown(sheet: Sheet) -> str:
    """Returns a table for Markdown."""
    lines = [sheet.titles, ["---"] * len(sheet.titles), *sheet.rows]
    escaped = ([str(cell).replace("|", r"\|") for cell in line] for line in lines)
    return "".join(f"| {' | '.join(line)} |\n" for line in escaped)


def csv_text(records: Sequence[Mapping[str, Any]], names: Sequence[str] = ()) -> str:
    """Returns a header and a line for each record, whose cells are by name; None is an empty cell.

    Without names there is a column for each that a record has, in the order in which they turn up.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, names or dict.fromkeys(name for record in records for name in record))
    writer.writeheader()
    writer.writerows({name: harmless(cell) for name, cell in record.items()} for record in records)
    return text.getvalue()


def csv_of(sheets: Iterable[Sheet]) -> str:
    """Returns the rows of all tables, each behind the title of its table; columns by their titles."""
    records = [
        {"table": sheet.title, **dict(zip(sheet.titles, row, strict=False))}
        for sheet in sheets
        for row in sheet.rows
    ]
    return csv_text(records)


def latex(sheet: Sheet) -> str:
    """Returns a `table` environment without the spare columns, to be read by LaTeX's input."""
    sheet = sheet.narrow()
    note = [] if not sheet.caption else [rf"  \par\smallskip\footnotesize {latex_text(sheet.caption)}"]
    lines = [
        r"% Needs \usepackage{booktabs}.",
        r"\begin{table}",
        r"  \centering",
        rf"  \caption{{{latex_text(sheet.title)}}}",
        rf"  \label{{tab:{sheet.file}}}",
        rf"  \begin{{tabular}}{{l{'r' * (len(sheet.titles) - 1)}}}",
        r"    \toprule",
        _latex_line(sheet.titles),
        r"    \midrule",
        *map(_latex_line, sheet.rows),
        r"    \bottomrule",
        r"  \end{tabular}",
        *note,
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def _latex_line(cells: Sequence[str]) -> str:
    # Braces keep a bracket at the start of a cell from being taken for an option.
    texts = (f"{{}}{latex_text(cell)}" if cell.startswith("[") else latex_text(cell) for cell in cells)
    return f"    {' & '.join(texts)} \\\\"


def latex_text(text: str) -> str:
    """Returns a text that LaTeX prints letter by letter, signs of numbers as such and not as hyphens."""
    plain = "".join(_SPECIAL.get(letter, letter) for letter in text)
    return _SIGN.sub(r"$\1$", plain)
