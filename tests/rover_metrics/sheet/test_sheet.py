"""A table for every reader, and how numbers are written in it."""

import csv
import io

from rich.console import Group

from rover_metrics.sheet.console import PlainConsole
from rover_metrics.sheet.render import csv_text, latex, latex_text, markdown, terminal
from rover_metrics.sheet.sheet import Sheet, interval_text, number, probability
from tests.support.snapshots import check_snapshot

NONE = "\N{EN DASH}"


class Link(str):
    """HTML, which no page escapes."""

    __slots__ = ()

    def __html__(self) -> str:
        return f"<a>{self}</a>"


SHEET = Sheet.of(
    [
        {"Metric": "Velocity [m/s²]", "95 %": "-0.5 to 0.5", "spare | two": "x", "<g>": "+1.20"},
        {"Metric": "[odd]", "95 %": NONE, "spare | two": "y", "<g>": "<0.001"},
        {"Metric": Link("$x_{2}"), "95 %": "[b]", "spare | two": "z", "<g>": "a-1"},
    ],
    "a_b: 50 % of #1 & more",
    caption="1 - 2 ~ x^2 {y} \\z $5, (-2)",
    findings=("torn",),
    spare=frozenset({"spare | two"}),
    codes=("CV", "", "X"),
    file="log_1",
)


def printed(*sheets: Sheet, width: int, style: bool = False) -> str:
    """What a terminal shows, its styles as escape sequences if asked for."""
    file = io.StringIO()
    colors = "standard" if style else None
    console = PlainConsole(file=file, width=width, force_terminal=style, color_system=colors)
    console.print(Group(*terminal(sheets, width)))
    return file.getvalue().replace("\x1b", "ESC")


def test_one_table_has_the_same_cells_for_every_reader() -> None:
    pairs = Sheet(("Pair", "rho"), (("a - b", "+0.3"),), "Pairs", caption="A caption. " * 12)
    parts = {
        "terminal, 120 columns": printed(SHEET, pairs, width=120),
        "terminal, 119 columns": printed(SHEET, width=119),
        "terminal, styles": printed(SHEET, pairs, width=400, style=True),
        "LaTeX": latex(SHEET),
        "LaTeX, no caption": latex(Sheet(("a",), (("b",),), "t")),
        "Markdown": markdown(SHEET),
        "HTML": SHEET.__html__(),
        "HTML, three columns, a row that ends early": Sheet(("a", "b", "c"), (("1",),)).__html__(),
    }
    check_snapshot("sheet.txt", "".join(f"== {name}\n{text}\n" for name, text in parts.items()))


def test_neither_control_characters_nor_markup_of_a_file_reach_a_terminal() -> None:
    bad = "x[/b]\x1b]0;owned\x07\x9b2J\r\x7f"
    odd = Sheet((bad, bad), ((bad, bad),), bad, bad, (bad,))
    shown = printed(odd, Sheet(("Pair",), ((bad,),), caption=bad), width=400)
    assert shown.replace("\n", "").isprintable()
    assert "ESC" not in shown
    assert shown.count("x[/b]?]0;owned??2J??") == 9


def test_cells_of_a_csv_are_read_back_and_none_is_a_formula() -> None:
    records: list[dict[str, object]] = [
        {"a": "=1+1", "b": None, "c": 0.1},
        {"a": 'x,"y"', "b": -1, "c": 1e-17},
    ]
    assert list(csv.DictReader(io.StringIO(csv_text(records)))) == [
        {"a": "'=1+1", "b": "", "c": "0.1"},
        {"a": 'x,"y"', "b": "-1", "c": "1e-17"},
    ]
    assert csv_text([], ("a", "b")) == "a,b\r\n"


def test_every_letter_is_printed_by_latex_as_it_is_and_signs_of_numbers_are_signs() -> None:
    assert latex_text("2025-01-16 -1, +0.5, a-1, (-2) -x \\~^&%$#_{}") == (
        r"2025-01-16 $-$1, $+$0.5, a-1, ($-$2) -x \textbackslash{}\textasciitilde{}"
        r"\textasciicircum{}\&\%\$\#\_\{\}"
    )


def test_a_number_has_four_digits_and_a_probability_is_as_in_papers() -> None:
    for value, shown in (
        *((None, NONE), (0.0, "0"), (1234567.8, "1234568"), (9876.5, "9876"), (123.456, "123.5")),
        *((-12.3456, "-12.35"), (1.0, "1.000"), (0.99996, "1.0000"), (0.012345, "0.0123")),
    ):
        assert number(value) == shown
        assert interval_text(None if value is None else (value, 2.0)).partition(" to ")[0] == shown
    for p, shown in ((None, NONE), (0.000999, "<0.001"), (0.001, "0.001"), (0.0456, "0.046")):
        assert probability(p) == shown
