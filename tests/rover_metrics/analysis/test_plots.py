from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D

from rover_metrics.analysis.log import Floats, Log
from rover_metrics.analysis.metric import METRICS
from rover_metrics.analysis.outcome import analyse
from rover_metrics.analysis.plots.aggregate import draw_aggregate, mean_and_band
from rover_metrics.analysis.plots.comparison import draw_comparison
from rover_metrics.analysis.plots.correlation import draw_correlation
from rover_metrics.analysis.plots.curves import MOST_POINTS, smoothed, thinned, upper_limit
from rover_metrics.analysis.plots.style import look, save, styled
from rover_metrics.analysis.plots.time_series import draw_time_series
from rover_metrics.analysis.study import Member, Options, Study
from rover_metrics.analysis.time_axis import AxisName, TimeAxis
from rover_metrics.thresholds import Thresholds

MakeLog = Callable[..., Log]
OKABE_ITO = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"}


@pytest.fixture
def study(make_log: MakeLog) -> Study:
    rng = np.random.default_rng(0)

    def log(seconds: int, clearance: float) -> Log:
        columns = {
            "Total Collisions": np.cumsum(rng.integers(0, 2, seconds)),
            "Obstacle Clearance": clearance + rng.random(seconds),
            "Is Rough Terrain": rng.integers(0, 2, seconds),
        }
        return make_log(columns)

    logs = [log(100, 0.3), log(200, 1.0), log(150, 2.0), log(120, 2.5)]
    members = [Member(log, f"log {i}", "ab"[i // 2]) for i, log in enumerate(logs)]
    metrics = tuple(METRICS[code] for code in ("TC", "OC", "RT"))
    return Study(tuple(members), ("a", "b"), Options(metrics, correlate=True))


def ungrouped(study: Study) -> Study:
    members = tuple(Member(member.log, member.label, "all") for member in study.members)
    return Study(members, ("all",), study.options)


def only_axes(figure: Figure | None) -> Axes:
    assert figure is not None
    return figure.axes[0]


def xs(line: Line2D) -> Floats:
    return np.asarray(line.get_xdata(), dtype=np.float64)


def ys(line: Line2D) -> Floats:
    return np.asarray(line.get_ydata(), dtype=np.float64)


def texts(figure: Figure) -> str:
    return "\n".join(text.get_text() for axes in figure.axes for text in axes.texts)


def test_each_log_is_a_curve_of_its_own_colour_and_line(study: Study) -> None:
    axes = only_axes(draw_time_series(ungrouped(study), METRICS["OC"], TimeAxis("none")))
    curves = [line for line in axes.lines if str(line.get_label()).startswith("log")]
    assert [line.get_label() for line in curves] == ["log 0", "log 1", "log 2", "log 3"]
    assert {to_hex(line.get_color()) for line in curves} < OKABE_ITO
    assert len({str(look(i)["linestyle"]) for i in range(4)}) == 4


def test_of_two_groups_each_has_one_look_and_one_name(study: Study) -> None:
    axes = only_axes(draw_time_series(study, METRICS["OC"], TimeAxis("none")))
    curves = axes.lines[:4]
    assert len({(to_hex(line.get_color()), str(line.get_linestyle())) for line in curves}) == 2
    assert axes.get_legend_handles_labels()[1] == ["a", "b"]


def test_thirty_curves_look_different() -> None:
    assert len({str(look(i)) for i in range(30)}) == 30


@pytest.mark.parametrize(
    ("axis", "interval", "end", "label"),
    [
        ("percentage", 1.0, 100.0, "Share of the episode [%]"),
        ("none", 1.0, 199.0, "Time since the episode began [s]"),
        ("fixed_interval", 50.0, 150.0, "Time since the episode began [s], means over 50 s"),
    ],
)
def test_the_time_axis_is_what_was_asked_for(
    study: Study, axis: AxisName, interval: float, end: float, label: str
) -> None:
    axes = only_axes(draw_time_series(study, METRICS["OC"], TimeAxis(axis, interval)))
    assert axes.get_xlabel() == label
    assert max(xs(line).max() for line in axes.lines[:4]) == end


def test_axes_carry_units_and_thresholds_their_values(study: Study) -> None:
    figure = draw_time_series(study, METRICS["OC"], TimeAxis("none"))
    axes = only_axes(figure)
    assert axes.get_ylabel() == "Obstacle clearance [m]"
    levels = {float(ys(line)[0]) for line in axes.lines if ys(line).size == 2}
    assert levels == {0.2, 0.5}
    assert figure is not None
    assert "collision threshold 0.2 m" in texts(figure)
    assert "min safe clearance 0.5 m" in texts(figure)


def test_rows_stand_behind_the_curve_only_where_they_do_not_hide_each_other(
    study: Study,
) -> None:
    few = Study(study.members[:2], study.groups, study.options)
    many = only_axes(draw_time_series(study, METRICS["OC"], TimeAxis("none"))).lines
    both = only_axes(draw_time_series(few, METRICS["OC"], TimeAxis("none"))).lines
    assert len(many) == 4 + 2  # and two thresholds
    assert len(both) == 2 * 2 + 2


def test_a_metric_without_values_gives_no_figure(study: Study) -> None:
    assert draw_time_series(study, METRICS["VR"], TimeAxis("none")) is None


def test_a_single_jolt_does_not_set_the_axis_and_is_told(make_log: MakeLog) -> None:
    column = np.full(1000, 10.0)
    column[500] = 427.0
    log = make_log({"IMU Acceleration Magnitude": column})
    study = Study((Member(log, "x", "all"),), ("all",), Options((METRICS["IM"],)))
    figure = draw_time_series(study, METRICS["IM"], TimeAxis("none"))
    assert only_axes(figure).get_ylim()[1] < 30
    assert figure is not None
    assert "1 value above the axis, the highest 427" in texts(figure)
    assert upper_limit([column], 0.0)[1:] == (1, 427.0)


def test_a_huge_series_is_thinned_but_keeps_its_peaks() -> None:
    values = np.sin(np.arange(1_000_000) / 1000)
    values[123_456], values[654_321] = 9.0, -9.0
    x, y = thinned(np.arange(1_000_000.0), values)
    assert y.size <= MOST_POINTS
    assert (y.max(), y.min()) == (9.0, -9.0)
    assert np.all(np.diff(x) > 0)
    at, curve = smoothed(np.arange(1_000_000.0), values, 0.001, "mean")
    assert at.size == curve.size <= 20_000
    np.testing.assert_allclose(curve[1000:-1000], np.sin(at[1000:-1000] / 1000), atol=0.06)


def test_the_median_is_not_lifted_by_a_jolt_and_the_mean_counts_it() -> None:
    values = np.zeros(100)
    values[50] = 90.0
    assert smoothed(np.arange(100.0), values, 0.05, "median")[1].max() == 0.0
    assert smoothed(np.arange(100.0), values, 0.05, "mean")[1].max() == pytest.approx(10.0)


def test_an_aggregate_is_mean_and_t_interval_of_the_episodes() -> None:
    curves = np.array([[1.0, 1.0, np.nan], [2.0, 3.0, np.nan], [3.0, np.nan, np.nan]])
    mean, low, high = mean_and_band(curves, 0.95)
    np.testing.assert_allclose(mean, [2, 2, np.nan])
    half = 4.30265273 * 1 / np.sqrt(3)  # t of 2 degrees of freedom
    np.testing.assert_allclose(high, [2 + half, 3, np.nan])
    np.testing.assert_allclose(low, [2 - half, 1, np.nan])


def test_an_aggregate_has_a_panel_a_metric_and_a_curve_a_group(study: Study) -> None:
    figure = draw_aggregate(study, TimeAxis())
    assert figure is not None
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "Collisions [scans/min]",
        "Obstacle clearance [m]",
        "Time on rough terrain [% of rows]",
    ]
    labels = [line.get_label() for line in figure.axes[1].lines[:2]]
    assert labels == ["a (2 episodes)", "b (2 episodes)"]


def test_a_correlation_is_written_into_its_cell(study: Study) -> None:
    result = analyse(study)
    figure = draw_correlation(result.correlations, study.options.metrics, 0.05)
    assert figure is not None
    assert len(result.correlations) == 3
    for item in result.correlations:
        assert f"{item.rho:+.2f}" in texts(figure)
    assert draw_correlation((), study.options.metrics, 0.05) is None


def test_a_comparison_shows_each_log_as_a_point_and_the_verdict(study: Study) -> None:
    result = analyse(study)
    figure = draw_comparison(study, result)
    assert figure is not None
    assert [ys(line).size for line in figure.axes[1].lines] == [2, 2]
    clearance = next(item for item in result.comparisons if item.code == "OC")
    assert f"p = {clearance.p_holm:.3f}, g = {clearance.hedges_g:+.2f}" in figure.axes[1].get_title(
        loc="right"
    )


def test_without_groups_a_comparison_shows_the_logs_side_by_side(study: Study) -> None:
    alone = ungrouped(study)
    figure = draw_comparison(alone, analyse(alone))
    assert figure is not None
    assert len(figure.axes[0].patches) == 4
    assert figure.get_supxlabel() == "1: log 0    2: log 1    3: log 2    4: log 3"


def test_files_are_png_and_pdf_and_the_same_bytes_again(study: Study, tmp_path: Path) -> None:
    written = []
    for folder in (tmp_path / "a", tmp_path / "b"):
        folder.mkdir()
        with styled():
            figure = draw_time_series(study, METRICS["OC"], TimeAxis("none"))
            assert figure is not None
            written.append(save(figure, folder, "plot"))
    for first, second in zip(*written, strict=True):
        assert first.read_bytes() == second.read_bytes()
    assert written[0][0].read_bytes().startswith(b"\x89PNG")
    assert written[0][1].read_bytes().startswith(b"%PDF")
    assert figure is not None
    pixels = imread(written[0][0])[..., :3]
    assert pixels.shape[:2] == (720, 1440)
    drawn = np.any(pixels < 0.9, axis=-1)
    assert 0.01 < drawn.mean() < 0.3


def test_the_thresholds_drawn_are_those_that_the_logs_had(study: Study) -> None:
    had = Thresholds(collision_threshold=0.3, min_safe_clearance=0.9)
    first, *others = ungrouped(study).members
    told = Member(replace(first.log, thresholds=had), first.label, "all")
    clearance, axis = METRICS["OC"], TimeAxis("none")
    alone = Study((told,), ("all",), study.options)
    assert alone.bounds(clearance) == {"collision_threshold": [0.3], "min_safe_clearance": [0.9]}
    mixed = Study((told, *others), ("all",), study.options)
    assert mixed.bounds(clearance) == {
        "collision_threshold": [0.2, 0.3],
        "min_safe_clearance": [0.5, 0.9],
    }
    for figure in (
        draw_time_series(alone, clearance, axis),
        draw_aggregate(replace(alone, options=Options((clearance,))), axis),
        draw_comparison(replace(alone, options=Options((clearance,))), analyse(alone)),
    ):
        axes = only_axes(figure)
        levels = [ys(line)[0] for line in axes.get_lines() if list(xs(line)) == [0, 1]]
        assert levels == [0.3, 0.9]
        assert "collision threshold 0.3 m" in " ".join(text.get_text() for text in axes.texts)
