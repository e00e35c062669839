from pathlib import Path

import pytest

from rover_metrics.analysis.options import UsageError, parse


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
    ("words", "valid"),
    [
        (["--versus", "b.csv", "--unit", "row"], "'log', 'episode'"),
        (["--unit", "episode"], "--unit has no effect without --versus"),
        (["--pair-by", "order"], "--pair-by has no effect without --versus"),
        (
            ["--versus", "b.csv", "--unit", "episode", "--pair-by", "order"],
            "pairs logs; give --unit log",
        ),
        (
            ["--versus", "b.csv", "--unit", "episode", "--pair-by", "seed"],
            "pairs logs; give --unit log",
        ),
        (["--versus", "b.csv", "--pair-by", "name"], "'seed', 'order', 'none'"),
        (["--versus", "b.csv", "--group-names", "x", "x"], "two different names"),
        (["--confidence-level", "1"], "between 0 and 1"),
        (["--iqr-multiplier", "0"], "above 0"),
        (["--fixed-interval", "5", "-n", "none"], "no effect with -n none"),
    ],
)
def test_words_that_make_no_sense_are_one_line_that_says_what_does(words: list[str], valid: str) -> None:
    with pytest.raises(UsageError, match=valid) as told:
        parse(["a.csv", *words])
    assert "\n" not in str(told.value)
