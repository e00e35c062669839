from pathlib import Path

import pytest

from rover_metrics.analysis.options import parse


def test_without_options_every_metric_is_reported_and_one_plot_drawn() -> None:
    options = parse(["a.csv", "b.csv"])
    assert (options.logs, options.versus) == ([Path("a.csv"), Path("b.csv")], [])
    assert options.metrics == ["TC", "CS", "SM", "TSR", "OC", "DT", "CV", "VORT", "IM", "RT", "VR"]
    assert (options.plots, options.normalize, options.unit) == (["time_series"], "percentage", "log")
    assert (options.output, options.group_names) == (Path("output"), ["first", "versus"])
    assert (options.pair_by, options.csv, options.latex, options.json) == ("seed", False, False, False)
    assert parse(["a.csv", "-m", "CV", "ALL"]).plots == ["comparison"]
    assert parse(["a.csv", "-m", "all", "-p"]).plots == []


@pytest.mark.parametrize(
    ("metrics", "plots", "output", "axis"),
    [
        ("--metrics", "--plot-types", "--output-dir", "--normalize"),
        ("-m", "-p", "-o", "-n"),
        ("--metrics", "--plots", "--output", "-n"),
    ],
)
def test_every_spelling_of_robo_terrains_options_is_taken(
    metrics: str, plots: str, output: str, axis: str
) -> None:
    """Those that its cli_main.py declares, the long ones and the short ones, and ours."""
    line = (
        f"a.csv b.csv {metrics} TC VR {plots} time_series comparison {output} out {axis} fixed_interval "
        "--iqr-multiplier 2 --save-outliers --confidence-level 0.9 --fixed-interval 2"
    )
    options = parse(line.split())
    assert (options.logs, options.metrics) == ([Path("a.csv"), Path("b.csv")], ["TC", "VR"])
    assert (options.plots, options.output) == (["time_series", "comparison"], Path("out"))
    assert (options.normalize, options.fixed_interval) == ("fixed_interval", 2.0)
    assert (options.iqr_multiplier, options.confidence_level, options.save_outliers) == (2.0, 0.9, True)


def test_short_options_are_options_of_their_own_joined_to_their_values_too() -> None:
    options = parse(["a.csv", "-mOC", "-pcorrelation", "-nnone", "-oplots"])
    assert (options.metrics, options.plots) == (["OC"], ["correlation"])
    assert (options.normalize, options.output) == ("none", Path("plots"))


@pytest.mark.parametrize(
    ("words", "axis"),
    [
        ("", ("percentage", 1.0)),
        ("-n none", ("none", 1.0)),
        ("-n fixed_interval", ("fixed_interval", 1.0)),
        ("--fixed-interval 5", ("fixed_interval", 5.0)),
    ],
)
def test_a_fixed_interval_is_a_second_and_the_axis_of_who_gives_one(
    words: str, axis: tuple[str, float]
) -> None:
    options = parse(["a.csv", *words.split()])
    assert (options.normalize, options.fixed_interval) == axis


@pytest.mark.parametrize(
    ("words", "valid"),
    [
        ("-p pie", "'time_series', 'correlation', 'aggregate', 'comparison'"),
        ("-n log", "'percentage', 'fixed_interval', 'none'"),
        *((f"--confidence-level {p}", "between 0 and 1, such as 0.95") for p in ("95", "1", "0")),
        *((f"--iqr-multiplier {k}", "give a number above 0") for k in ("-1", "0")),
        *((f"--gap {s}", "give a number above 0") for s in ("0", "inf")),
        ("--fixed-interval nan", "give a number above 0"),
        ("--fixed-interval 5 -n none", "no effect with -n none; give -n fixed_interval"),
        ("--unit episode", "--unit has no effect without --versus"),
        ("--pair-by order", "--pair-by has no effect without --versus"),
        ("--group-names a b", "--group-names has no effect without --versus"),
        ("--versus a.csv", "is in both groups"),
        ("--versus b.csv --unit row", "'log', 'episode'"),
        *(
            (f"--versus b.csv --unit episode --pair-by {by}", f"{by} pairs logs; give --unit log")
            for by in ("seed", "order")
        ),
        ("--versus b.csv --pair-by name", "'seed', 'order', 'none'"),
        ("--versus b.csv --group-names x x", "two different names"),
        ("--versus b.csv --group-names x \x1b", "names that can be printed"),
        ("--conf 0.9", "unrecognized arguments: --conf"),  # an option may get a sister
    ],
)
def test_words_that_make_no_sense_are_one_line_that_says_what_does(words: str, valid: str) -> None:
    with pytest.raises(UsageError, match=valid) as told:
        parse(["a.csv", *words.split()])
    assert "\n" not in str(told.value)
