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


def test_every_spelling_of_robo_terrains_options_is_taken() -> None:
    """Those that its cli_main.py declares, the long ones and the short ones."""
    common = [
        "--iqr-multiplier",
        "2",
        "--save-outliers",
        "--confidence-level",
        "0.9",
        "--fixed-interval",
        "2",
    ]
    long = parse(
        [
            "a.csv",
            "b.csv",
            "--metrics",
            "TC",
            "VR",
            "--plot-types",
            "time_series",
            "comparison",
            "--output-dir",
            "out",
            "--normalize",
            "fixed_interval",
        ]
        + common
    )
    short = parse(
        [
            "a.csv",
            "b.csv",
            "-m",
            "TC",
            "VR",
            "-p",
            "time_series",
            "comparison",
            "-o",
            "out",
            "-n",
            "fixed_interval",
        ]
        + common
    )
    assert long == short
    assert (long.plots, long.output) == (["time_series", "comparison"], Path("out"))
    assert (long.iqr_multiplier, long.confidence_level, long.fixed_interval) == (2.0, 0.9, 2.0)
    own = parse(
        [
            "a.csv",
            "b.csv",
            "--metrics",
            "TC",
            "VR",
            "--plots",
            "time_series",
            "comparison",
            "--output",
            "out",
            "-n",
            "fixed_interval",
        ]
        + common
    )
    assert own == long


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
