"""Cells side by side: their values, statistics by hand, and what is compared run by run."""

import json
import math
import re
from dataclasses import replace

import pytest
from rich.console import Console

from harness import __version__
from harness.scenario.bound import Bound
from harness.scenario.comparison import comparisons_of, title_of
from harness.scenario.outputs import print_tables
from harness.scenario.tables import csv_of, json_of, latex_of, runs_of
from harness.scenario.verdict import Attempt, Measured, Verdict, verdicts_of
from tests.harness.scenario.conftest import MakeCases
from tests.support.snapshots import check_snapshot

EXPECT = "{truth.speed: {over: mean, max: 3}, truth.rock_contacts: {max: 5}}"
LEO, ZERO = (1.0, 2.0, 3.0), (1.5, 3.0, 4.5)
T = 4.302652729911275  # Student's t at 97.5 % for 2 degrees of freedom, from a table


def verdict(
    make_cases: MakeCases, matrix: str = "robot: [leo, rover_zero4wd]", more: str = ""
) -> Verdict:
    """Cells of three runs: LEO and ZERO metres a second, the last one too many; 0 contacts and more."""
    speeds = LEO + ZERO + ZERO + LEO
    cases = make_cases(EXPECT, f"matrix: {{{matrix}}}\nseeds: [4, 7, 9]{more}")
    (made,) = verdicts_of(
        [
            Attempt(
                case,
                ("truth.speed: mean 4.5 m/s > 3 m/s",) if speed > 3 else (),
                measured=(Measured(speed, "m/s"), Measured(float(number))),
            )
            for number, (case, speed) in enumerate(zip(cases, speeds, strict=False))
        ]
    )
    return made


def test_a_cell_is_summed_up_and_differs_from_the_first_as_by_hand(make_cases: MakeCases) -> None:
    compared = comparisons_of(verdict(make_cases))
    assert [cell.name for cell in compared.cells] == ["leo", "rover_zero4wd"]
    assert [cell.good for cell in compared.cells] == [3, 2]
    speed, contacts = compared.quantities
    assert (speed.title, speed.heading) == ("truth.speed, mean", "truth.speed, mean [m/s]")
    assert (contacts.title, contacts.heading) == ("truth.rock_contacts, highest",) * 2
    for bound, title in (
        (Bound(min=1), "q, lowest"),
        (Bound(min=1, max=2, window=(1, 2.5)), "q, nearest to a limit, 1 to 2.5 s"),
        (Bound(max=1, over="share", share=0.5), "q, share within limits"),
    ):
        assert title_of("q", bound) == title
    assert title_of("topic./scan.count", Bound(min=1, window=(0, 2))) == "topic./scan.count, 0 to 2 s"
    first, second = speed.rows
    half = T * 1.0 / math.sqrt(3)
    assert (first.values, first.summary.mean, first.difference) == (LEO, 2.0, None)
    assert first.summary.interval == pytest.approx((2.0 - half, 2.0 + half))
    difference = second.difference
    assert difference is not None
    assert difference.paired
    assert difference.difference == pytest.approx(1.0)
    # 0.5, 1, 1.5 run by run: their deviation is 0.5.
    assert difference.interval == pytest.approx(
        (1.0 - T * 0.5 / math.sqrt(3), 1.0 + T * 0.5 / math.sqrt(3))
    )
    pooled = math.sqrt((1.0 + 2.25) / 2)
    assert difference.hedges_g == pytest.approx((1 - 3 / 15) * 1.0 / pooled)
    assert difference.cliffs_delta == pytest.approx((6 - 2) / 9)
    # All three signs alike happens twice in eight; two quantities are compared.
    assert difference.p == pytest.approx(0.25)
    assert difference.p_holm == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("matrix", "paired"),
    [
        ("driver: [wander, straight]", True),
        ("noise: [white, null]", True),
        ("soil: [null, firm]", True),
        ("difficulty: [0, 1]", False),
    ],
)
def test_runs_are_pairs_if_both_drove_in_the_same_worlds(
    matrix: str, paired: bool, make_cases: MakeCases
) -> None:
    compared = comparisons_of(verdict(make_cases, matrix))
    difference = compared.quantities[0].rows[1].difference
    assert difference is not None
    assert difference.paired == paired


def test_runs_without_a_value_are_left_out_with_their_partners(make_cases: MakeCases) -> None:
    made = verdict(make_cases)
    attempts = list(made.attempts)
    attempts[0] = Attempt(attempts[0].case, error="no disk")
    attempts[4] = replace(attempts[4], measured=(Measured(None, "m/s"), Measured(1.0)))
    (made,) = verdicts_of(attempts)
    speed, _ = comparisons_of(made).quantities
    assert speed.unit == "m/s"
    assert [row.summary.n for row in speed.rows] == [2, 2]
    difference = speed.rows[1].difference
    assert difference is not None
    assert (difference.n, difference.means) == ((1, 1), (3.0, 4.5))  # the last seed alone


def test_csv_and_json_have_every_number(make_cases: MakeCases) -> None:
    alone = verdicts_of([Attempt(case, error="no disk") for case in make_cases(EXPECT, name="=alone")])
    several = [comparisons_of(made) for made in (verdict(make_cases), *alone)]
    read = json.loads(json_of(several))  # what is in it twice: its numbers are those of the CSV
    assert read["scenarios"][0]["cells"][1]["quantities"]["truth.speed, mean"]["difference"] == 1.0
    for scenario in read["scenarios"]:
        scenario["cells"] = [cell | {"quantities": [*cell["quantities"]]} for cell in scenario["cells"]]
    columns = [set(runs_of(some).splitlines()[0].split(",")) for some in (several, several[::-1])]
    assert columns[0] == columns[1]  # also where the first run has not been driven
    text = csv_of(several) + json.dumps(read, indent=1).replace(__version__, "VERSION")
    check_snapshot("scenario_numbers.txt", re.sub(r"[^ \",']*/(=?\w+\.scenario\.yaml)", r"\1", text))


def test_a_terminal_gets_a_table_a_quantity(
    make_cases: MakeCases, capsys: pytest.CaptureFixture[str]
) -> None:
    alone = verdicts_of([Attempt(case) for case in make_cases(EXPECT, name="alone")])
    print_tables(Console(width=80), [verdict(make_cases, "noise: [white, null]")])
    print_tables(Console(width=100), [*alone, verdict(make_cases)])
    both = "noise: [white, null], robot: [leo, rover_zero4wd]"
    print_tables(Console(width=120), [several := verdict(make_cases, both, "\ncompare: robot")])
    print(latex_of([comparisons_of(several)]))
    check_snapshot("scenario_tables.txt", capsys.readouterr().out)
