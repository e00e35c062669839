"""Tables for LaTeX, read back by the rules of its tabular."""

import re

from rover_metrics.analysis.tables.latex import escaped, latex
from rover_metrics.analysis.tables.sheets import Row, Sheet

SHEET = Sheet(
    "log_1",
    "a_b: 50 % of #1 & more",
    "Metric",
    (
        Row("CV", "Current velocity [m/s²]", {"95 %": "-0.5 to 0.5", "spare": "x", "g": "+1.20"}),
        Row("", "[odd]", {"95 %": "–", "spare": "x", "g": "<0.001"}),  # noqa: RUF001
    ),
    "1 - 2 ~ x^2 {y} \\z $5",
    spare=frozenset({"spare"}),
)


def test_a_table_has_a_caption_a_label_and_a_cell_a_column() -> None:
    text = latex(SHEET)
    lines = text.splitlines()
    rows = [
        re.split(r"(?<!\\) & ", line.strip().removesuffix(r" \\"))
        for line in lines
        if line.endswith(r"\\")
    ]
    assert rows == [
        ["Metric", r"95 \%", "g"],
        [r"Current velocity [m/s\textsuperscript{2}]", "$-$0.5 to 0.5", "$+$1.20"],
        ["{}[odd]", "--", r"\textless{}0.001"],
    ]
    assert r"\begin{tabular}{lrr}" in text
    assert r"\caption{a\_b: 50 \% of \#1 \& more}" in text
    assert r"\label{tab:log_1}" in text
    opened, closed = (re.findall(rf"\\{word}{{(\w+)}}", text) for word in ("begin", "end"))
    assert opened == closed[::-1] == ["table", "tabular"]
    assert [lines.index(f"    \\{rule}rule") for rule in ("top", "mid", "bottom")] == [6, 8, 11]


def test_every_letter_is_printed_as_it_is() -> None:
    assert escaped(SHEET.caption) == (
        r"1 - 2 \textasciitilde{} x\textasciicircum{}2 \{y\} \textbackslash{}z \$5"
    )
    assert escaped("2025-01-16 -1, +0.5, a-1, (-2) -x") == "2025-01-16 $-$1, $+$0.5, a-1, ($-$2) -x"


def test_a_table_without_a_caption_below_has_none() -> None:
    assert r"\footnotesize" in latex(SHEET)
    assert r"\footnotesize" not in latex(Sheet("x", "t", "Metric", (), ""))
