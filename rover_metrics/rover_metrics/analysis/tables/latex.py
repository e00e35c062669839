"""Tables for LaTeX, with booktabs: one `table` environment each, to be read by input."""

import re

from rover_metrics.analysis.tables.sheets import Sheet

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


def latex(sheet: Sheet) -> str:
    """Returns a table with the columns that fit a page."""
    titles = sheet.titles(narrow=True)
    rows = [[row.name, *(row.cells[title] for title in titles)] for row in sheet.rows]
    note = [] if not sheet.caption else [rf"  \par\smallskip\footnotesize {escaped(sheet.caption)}"]
    lines = [
        r"% Needs \usepackage{booktabs}.",
        r"\begin{table}",
        r"  \centering",
        rf"  \caption{{{escaped(sheet.title)}}}",
        rf"  \label{{tab:{sheet.file}}}",
        rf"  \begin{{tabular}}{{l{'r' * len(titles)}}}",
        r"    \toprule",
        _line([sheet.head, *titles]),
        r"    \midrule",
        *map(_line, rows),
        r"    \bottomrule",
        r"  \end{tabular}",
        *note,
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def _line(cells: list[str]) -> str:
    return f"    {' & '.join(map(_cell, cells))} \\\\"


def _cell(text: str) -> str:
    """Returns a cell; braces keep a bracket at the start of a line from being taken for an option."""
    return f"{{}}{escaped(text)}" if text.startswith("[") else escaped(text)


def escaped(text: str) -> str:
    """Returns a text that LaTeX prints letter by letter, signs of numbers as such and not as hyphens."""
    plain = "".join(_SPECIAL.get(letter, letter) for letter in text)
    return _SIGN.sub(r"$\1$", plain)
