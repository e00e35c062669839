"""The command line of analyze: RoboTerrain's options, the defaults, and what makes no sense."""

from pathlib import Path

import pytest

from rover_metrics.analysis.options import parse
from tests.support.complaint import complaint


def test_without_options_every_metric_is_reported_and_one_plot_drawn() -> None:
    options = parse(["a.csv", "b.csv"])
    assert (options.logs, options.versus) == ([Path("a.csv"), Path("b.csv")], [])
    assert options.metrics == ["TC", "CS", "SM", "TSR", "OC", "DT", "CV", "VORT", "IM", "RT", "VR"]
    assert (options.plots, options.normalize, options.unit) == (["time_series"], "percentage", "log")
    assert (options.output, options.group_names) == (Path("output"), ["first", "versus"])
    assert (options.pair_by, options.csv, options.latex, options.json) == ("seed", False, False, None)
    assert parse(["a.csv", "-m", "CV", "ALL"]).plots == ["comparison"]
    assert parse(["a.csv", "-m", "all", "-p"]).plots == []


@pytest.mark.parametrize(
    "spelling",
    ["--metrics --plot-types --output-dir --normalize", "-m -p -o -n", "--metrics --plots --output -n"],
)
def test_every_spelling_of_robo_terrains_options_is_taken(spelling: str) -> None:
    """Those that its cli_main.py declares, the long ones and the short ones, and ours."""
    metrics, plots, output, axis = spelling.split()
    line = (
        f"a.csv {metrics} TC VR {plots} time_series comparison {output} out {axis} fixed_interval "
        "--iqr-multiplier 2 --save-outliers --confidence-level 0.9 --fixed-interval 2"
    )
    options = parse(line.split())
    assert (options.metrics, options.plots) == (["TC", "VR"], ["time_series", "comparison"])
    assert (options.output, options.normalize) == (Path("out"), "fixed_interval")
    assert (options.fixed_interval, options.iqr_multiplier) == (2.0, 2.0)
    assert (options.confidence_level, options.save_outliers) == (0.9, True)


def test_a_fixed_interval_is_a_second_and_the_axis_of_who_gives_one() -> None:
    for words, axis in (
        ("", ("percentage", 1.0)),
        ("-n none", ("none", 1.0)),
        ("-n fixed_interval", ("fixed_interval", 1.0)),
        ("--fixed-interval 5", ("fixed_interval", 5.0)),
    ):
        options = parse(["a.csv", *words.split()])
        assert (options.normalize, options.fixed_interval) == axis


@pytest.mark.parametrize(
    ("words", "valid"),
    [
        ("-p pie", "'time_series', 'correlation', 'aggregate', 'comparison'"),
        ("-n log", "'percentage', 'fixed_interval', 'none'"),
        *((f"--confidence-level {p}", "between 0 and 1, such as 0.95") for p in ("1", "0")),
        *((f"{option} 0", "give a number above 0") for option in ("--iqr-multiplier", "--gap")),
        *((f"--fixed-interval {s}", "give a number above 0") for s in ("nan", "inf")),
        ("--fixed-interval 5 -n none", "no effect with -n none; give -n fixed_interval"),
        *((f"{one}", "has no effect without --versus") for one in ("--unit log", "--pair-by order")),
        ("--group-names a b", "--group-names has no effect without --versus"),
        ("--versus a.csv", "is in both groups"),
        ("--versus b.csv --unit episode --pair-by seed", "seed pairs logs; give --unit log"),
        ("--versus b.csv --unit episode --pair-by order", "order pairs logs; give --unit log"),
        ("--versus b.csv --pair-by name", "'seed', 'order', 'none'"),
        ("--versus b.csv --unit row", "'log', 'episode'"),
        ("--versus b.csv --group-names x x", "two different names"),
        ("--versus b.csv --group-names x \x1b", "names that can be printed"),
        ("--conf 0.9", "unrecognized arguments: --conf"),  # an option may get a sister
    ],
)
def test_wrong_words_are_one_line(words: str, valid: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert valid in complaint(parse, ["a.csv", *words.split()], capsys)  # type: ignore[arg-type]
