from pathlib import Path

import pytest

from rover_metrics.analysis.options import UsageError, parse


def test_without_options_every_metric_is_reported_and_one_plot_drawn() -> None:
    options = parse(["a.csv", "b.csv"])
    assert (options.logs, options.versus) == ([Path("a.csv"), Path("b.csv")], [])
    assert options.metrics == ["TC", "CS", "SM", "OC", "DT", "CV", "VORT", "IM", "RT", "VR"]
    assert (options.plots, options.normalize, options.unit) == (["time_series"], "percentage", "log")
    assert (options.output, options.group_names) == (Path("output"), ["first", "versus"])


def test_short_options_are_options_of_their_own_joined_to_their_values_too() -> None:
    options = parse(["a.csv", "-mOC", "-pcorrelation", "-nnone", "-oplots"])
    assert (options.metrics, options.plots) == (["OC"], ["correlation"])
    assert (options.normalize, options.output) == ("none", Path("plots"))


@pytest.mark.parametrize(
    ("words", "valid"),
    [
        (["--versus", "b.csv", "--unit", "row"], "'log', 'episode'"),
        (["--unit", "episode"], "--unit has no effect without --versus"),
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
