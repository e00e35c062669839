"""What people read of a result."""

import io
import re
from dataclasses import replace

import pytest
from rich.console import Console, Group
from rover_metrics.analysis.tables.sheets import number, probability
from rover_metrics.analysis.tables.terminal import report

from rover_metrics.analysis.result import Result
from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.correlation import Correlation
from rover_metrics.analysis.statistics.summary import Summary
from tests.support.results import LOG, RESULT, SPEED

SHARE = Summary(60, 12.5, 9.0, interval=(6.0, 22.0))
COMPARISON = Comparison(
    "CV", (3, 4), (0.1, 0.35), 0.25, (0.15, 0.375), "exact permutation", 0.02, 0.03, 0.05, 1.234, -0.5
)


def printed(result: Result, width: int = 220) -> list[str]:
    file = io.StringIO()
    Console(file=file, width=width, highlight=False).print(Group(*report(result, width)))
    return file.getvalue().splitlines()


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.split("  ") if cell.strip()]


def table(lines: list[str], first: str) -> dict[str, dict[str, str]]:
    """Rows of the table whose first title is given, by their first cell."""
    start = next(i for i, line in enumerate(lines) if line.strip().startswith(f"{first} "))
    titles, found = cells(lines[start]), {}
    for line in lines[start + 2 :]:
        row = cells(line)
        if len(row) > len(titles):  # a short code and its metric
            row[:2] = [f"{row[0]} {row[1]}"]
        if len(row) != len(titles):
            break
        found[row[0]] = dict(zip(titles[1:], row[1:], strict=True))
    return found


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (None, "–"),  # noqa: RUF001
        (0.0, "0"),
        (1234567.8, "1234568"),
        (9876.5, "9876"),
        (123.456, "123.5"),
        (-12.3456, "-12.35"),
        (1.0, "1.000"),
        (0.99996, "1.0000"),
        (0.012345, "0.0123"),
        (-0.00004, "-0.0000"),
    ],
)
def test_a_number_has_four_digits(value: float | None, shown: str) -> None:
    assert number(value) == shown


@pytest.mark.parametrize(
    ("p", "shown"),
    [(None, "–"), (0.000999, "<0.001"), (0.001, "0.001"), (0.0456, "0.046"), (1.0, "1.000")],  # noqa: RUF001
)
def test_a_probability_is_as_in_papers(p: float | None, shown: str) -> None:
    assert probability(p) == shown


def test_a_logs_statistics_stand_under_their_titles() -> None:
    lines = printed(RESULT)
    assert lines[1] == "[b]x: 60 rows, 59 s"
    assert table(lines, "Metric") == {
        "CV Current velocity [m/s]": {
            "Mean": "0.5200",
            "90 % rows": "0.5000 to 0.5400",
            "90 % blocks": "0.4700 to 0.5700",
            "Median": "0.5100",
            "SD": "0.0800",
            "Min": "0.1200",
            "Max": "0.9300",
            "n": "60",
            "n eff.": "21",
            "Outliers kept": "3",
            "Per metre": "1.750",
        }
    }
    text = " ".join(" ".join(lines).split())
    assert "Outliers: beyond 2.5 interquartile ranges, kept." in text
    assert "90 % blocks: by block bootstrap, the one to quote" in text
    (removed,) = table(printed(replace(RESULT, outliers_removed=True)), "Metric").values()
    assert removed["Outliers removed"] == "3"


def test_a_narrow_terminal_gets_fewer_columns_from_120_on_all() -> None:
    narrow, wide = (next(iter(table(printed(RESULT, w), "Metric").values())) for w in (119, 150))
    assert set(wide) - set(narrow) == {"90 % rows", "Median", "n", "Outliers kept", "Per metre"}
    assert "Median" in " ".join(printed(RESULT, 120))
    logs = replace(RESULT, logs=(LOG, LOG), across={"all logs": {"CV": SPEED}})
    pair = replace(RESULT, groups=("a", "b"), comparisons=(COMPARISON,))
    for result, left_out in ((logs, {"Median"}), (pair, {"Difference", "p", "delta", "n"})):
        titles = []
        for width in (119, 150):
            lines = printed(result, width)
            head = [line for line in lines if line.startswith(" Metric ")][-1]  # not indented
            titles.append(set(cells(head)))
        assert titles[1] - titles[0] == left_out


def test_numbers_end_below_their_titles() -> None:
    found = (Correlation("CV", "OC", 0.3, 50, 20.6, 0.02), Correlation("TC", "OC", -0.4, 6, 3.0, 0.0001))
    lines = printed(replace(RESULT, correlations=found))
    start = next(i for i, line in enumerate(lines) if line.startswith(" Pair "))
    ends = [[match.end() for match in re.finditer(r"\S+( \S+)*", lines[start + i])] for i in (0, 2, 3)]
    assert ends[0][1:] == ends[1][1:] == ends[2][1:]


def test_a_terminal_shows_heads_bold_what_is_odd_yellow_and_notes_dim() -> None:
    odd, pair = replace(LOG, findings=("torn",)), Correlation("CV", "OC", 0.3, 50, 20.6, 0.02)
    result = replace(
        RESULT,
        logs=(odd, odd),
        groups=("a", "b"),
        across={"a": {"CV": SPEED}},
        correlations=(pair,),
        comparisons=(COMPARISON,),
    )
    file, width = io.StringIO(), 400
    console = Console(file=file, width=width, force_terminal=True, color_system="standard")
    console.print(Group(*report(result, width)), highlight=False)
    lines = file.getvalue().splitlines()
    for style, begins in (
        ("\x1b[1m", ("[b]x (", "Across the logs", "Correlation within", "b against a,", "CV  ")),
        ("\x1b[33m", ("  odd: torn",)),
        ("\x1b[2m", ("Spearman's rank",)),
    ):
        for begin in begins:
            assert any(style + begin in line for line in lines), begin


def test_the_head_of_a_log_tells_episodes_group_and_what_is_odd() -> None:
    log = replace(LOG, rows=1, duration=1234567.25, episodes=3, findings=("one", "two"), group="b")
    twice = replace(RESULT, logs=(replace(LOG, episodes=2),))
    assert printed(twice)[1] == "[b]x: 60 rows, 59 s, 2 episodes"
    lines = printed(replace(RESULT, logs=(log, LOG), groups=("a", "b")))
    assert lines[1:4] == ["[b]x (b): 1 row, 1234567.25 s, 3 episodes", "  odd: one", "  odd: two"]


def test_several_logs_are_summed_up_across() -> None:
    across = {"a": {"CV": SPEED, "RT": SHARE}, "b": {"CV": Summary(0)}}
    lines = printed(replace(RESULT, logs=(LOG, LOG), groups=("a", "b"), across=across))
    start = next(i for i, line in enumerate(lines) if line.startswith("Across"))
    assert lines[start] == "Across the logs of a, each one observation"
    assert table(lines[start:], "Metric") == {
        "CV Current velocity [m/s]": {
            "Mean of means": "0.5200",
            "90 % t": "0.5000 to 0.5400",
            "Median": "0.5100",
            "SD": "0.0800",
            "Min": "0.1200",
            "Max": "0.9300",
            "Logs": "60",
        },
        "RT Time on rough terrain [% of rows]": {
            "Mean of means": "12.50",
            "90 % t": "6.000 to 22.00",
            **dict.fromkeys(("Median", "SD", "Min", "Max"), "–"),  # noqa: RUF001
            "Logs": "60",
        },
    }
    assert not any(line.startswith("Across") for line in printed(replace(RESULT, across=across)))
    one = printed(replace(RESULT, logs=(LOG, LOG), across={"all logs": {"CV": SPEED}}))
    assert "Across the logs, each one observation" in one


def test_correlations_are_listed_strongest_first() -> None:
    found = (
        Correlation("CV", "OC", 0.3, 50, 20.6, 0.02, 0.04),
        Correlation("TC", "OC", -0.456, 60, 30.0, 0.0001, None),
    )
    rows = table(printed(replace(RESULT, correlations=found)), "Pair")
    assert list(rows.items()) == [
        ("TC - OC", {"rho": "-0.46", "p": "<0.001", "p (Holm)": "–", "n": "60", "n eff.": "30"}),  # noqa: RUF001
        ("CV - OC", {"rho": "+0.30", "p": "0.020", "p (Holm)": "0.040", "n": "50", "n eff.": "21"}),
    ]


def test_a_comparison_is_the_second_group_against_the_first() -> None:
    item = COMPARISON
    result = replace(RESULT, groups=("a", "b"), unit="episode", comparisons=(item,))
    lines = printed(result)
    start = lines.index("b against a, each episode one observation")
    assert table(lines[start:], "Metric") == {
        "CV Current velocity [m/s]": {
            "a mean": "0.1000",
            "b mean": "0.3500",
            "Difference": "0.2500",
            "90 %": "0.1500 to 0.3750",
            "p": "0.020",
            "p (Holm)": "0.030",
            "g": "+1.23",
            "delta": "-0.50",
            "n": "3 + 4",
        }
    }

    def caption(*items: Comparison) -> str:
        return " ".join(" ".join(printed(replace(result, comparisons=items))[start:]).split())

    assert "p: exact permutation, two-sided. Interval: Welch." in caption(item)
    assert caption(item).endswith("Holm: adjusted for the number of metrics.")
    result = replace(result, notes=("So few episodes.", "Really."))
    assert caption(item).endswith("So few episodes. Really.")
    pairs = replace(item, paired=True, n=(3, 3))
    assert "Interval: Student's, of the differences." in caption(pairs)
    lines = printed(replace(result, comparisons=(pairs,)))
    start = lines.index("b against a, each pair of episodes one observation")
    assert table(lines[start:], "Metric")["CV Current velocity [m/s]"]["n"] == "3 pairs"
    assert "p: Mann-Whitney U and exact permutation" in caption(
        item, replace(item, test="Mann-Whitney U")
    )
    start = 0
    untested = replace(item, test=None, p=None, p_holm=None, smallest_p=None)
    assert "p: " not in caption(untested)
    assert caption(untested).endswith("So few episodes. Really.")


def test_json_has_every_field_and_null_for_what_is_no_number() -> None:
    odd = replace(SPEED, mean=float("nan"), interval=(0.5, float("inf")))
    text = replace(RESULT, logs=(replace(LOG, metrics={"CV": odd}, label="é"),)).to_json()
    assert '"mean": null' in text
    assert '"interval": [\n            0.5,\n            null\n          ]' in text
    assert '"label": "é"' in text
