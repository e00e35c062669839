from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation, Text
from scipy import stats

from rover_metrics.analysis.logs.log import Floats, Log
from rover_metrics.analysis.logs.time_axis import AxisName, TimeAxis, on_grid
from rover_metrics.analysis.metric import METRICS, other_metric
from rover_metrics.analysis.outcome import analyse
from rover_metrics.analysis.plots.aggregate import draw_aggregate, mean_and_band
from rover_metrics.analysis.plots.comparison import draw_comparison
from rover_metrics.analysis.plots.correlation import draw_correlation
from rover_metrics.analysis.plots.style import STYLE, legend_columns, look, lower_end, metric_grid, save
from rover_metrics.analysis.plots.time_series import (
    MOST_POINTS,
    draw_time_series,
    smoothed,
    thinned,
    upper_limit,
)
from rover_metrics.analysis.statistics.correlation import Correlation
from rover_metrics.analysis.study import Member, Options, Study
from rover_metrics.core.thresholds import Thresholds

MakeLog = Callable[..., Log]
OKABE_ITO = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"]


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
    return Study(tuple(members), ("a", "b"), Options(metrics, plots=("correlation",)))


def ungrouped(study: Study) -> Study:
    members = tuple(Member(member.log, member.label, "all") for member in study.members)
    return Study(members, ("all",), study.options)


def one_column(make_log: MakeLog, name: str, *logs: Floats, groups: str = "") -> Study:
    """A study of one column, a log each; in groups as their letters say."""
    metric = next((m for m in METRICS.values() if m.column == name), None) or other_metric(name)
    letters = groups or "a" * len(logs)
    members = [Member(make_log({name: log}), f"log {i}", letters[i]) for i, log in enumerate(logs)]
    return Study(tuple(members), tuple(sorted(set(letters))), Options((metric,), plots=("correlation",)))


def over(study: Study, axis: TimeAxis) -> Study:
    return replace(study, options=replace(study.options, axis=axis))


def only_axes(figure: Figure | None) -> Axes:
    assert figure is not None
    return figure.axes[0]


def xs(line: Line2D) -> Floats:
    return np.asarray(line.get_xdata(), dtype=np.float64)


def ys(line: Line2D) -> Floats:
    return np.asarray(line.get_ydata(), dtype=np.float64)


def texts(figure: Figure) -> str:
    return "\n".join(text.get_text() for axes in figure.axes for text in axes.texts)


@pytest.mark.parametrize("code", ["TC", "OC", "RT"])
def test_each_log_is_a_running_curve_of_its_own_colour_and_line(study: Study, code: str) -> None:
    """Levels as the median over a twentieth, all else as the mean over a tenth; nine rows at least."""
    metric = METRICS[code]
    axes = only_axes(draw_time_series(over(ungrouped(study), TimeAxis("none")), metric))
    curves = [line for line in axes.lines if str(line.get_label()).startswith("log")]
    lowest = [f", lowest {m.log.columns['Obstacle Clearance'].min():.4g}" for m in study.members]
    names = [f"log {i}{lowest[i] if code == 'OC' else ''}" for i in range(4)]
    assert [line.get_label() for line in curves] == names
    assert [to_hex(line.get_color()) for line in curves] == OKABE_ITO[:4]
    assert len({str(look(i)["linestyle"]) for i in range(4)}) == 4
    for member, curve in zip(study.members, curves, strict=True):
        values = pd.Series(study.series(member.log, metric).values)
        share = 0.05 if code == "OC" else 0.1
        running = values.rolling(max(9, round(share * len(values))), center=True, min_periods=1)
        expected = (running.median() if code == "OC" else running.mean()).dropna()
        assert ys(curve) == pytest.approx(expected.to_numpy())
        assert xs(curve) == pytest.approx(expected.index)
    end = axes.get_ylim()[1]
    assert axes.get_ylim()[0] == 0
    assert end == pytest.approx(1.1 * max(ys(line).max() for line in curves)) or code == "RT"
    assert (
        axes.get_title(loc="left")
        == {
            "TC": "Collisions: running mean over 10 % of the episode",
            "OC": "Obstacle clearance: running median over 5 % of the episode; \u25bc: lowest",
            "RT": "Time on rough terrain: running mean over 10 % of the episode",
        }[code]
    )


def test_a_share_is_never_drawn_beyond_all_of_it(make_log: MakeLog) -> None:
    study = one_column(make_log, "Is Rough Terrain", np.ones(50))
    for figure in (draw_time_series(study, METRICS["RT"]), draw_aggregate(study)):
        assert only_axes(figure).get_ylim() == (0, 105.0)


@pytest.mark.parametrize(("logs", "named"), [(12, 12), (13, 1)])
def test_of_two_groups_or_many_logs_each_group_has_one_look_and_one_name(
    study: Study, logs: int, named: int
) -> None:
    axes = only_axes(draw_time_series(over(study, TimeAxis("none")), METRICS["OC"]))
    looks = [(to_hex(line.get_color()), str(line.get_linestyle())) for line in axes.lines[:4]]
    assert looks[0] == looks[1] != looks[2] == looks[3]
    lowest = [study.members[i].log.columns["Obstacle Clearance"].min() for i in (0, 2)]
    names = [f"{group}, lowest {least:.4g}" for group, least in zip("ab", lowest, strict=True)]
    assert axes.get_legend_handles_labels()[1] == names
    log = study.members[0].log
    many = Study(tuple(Member(log, f"log {i}", "all") for i in range(logs)), ("all",), study.options)
    axes = only_axes(draw_time_series(over(many, TimeAxis("none")), METRICS["OC"]))
    assert len(axes.get_legend_handles_labels()[1]) == named


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
    axes = only_axes(draw_time_series(over(study, TimeAxis(axis, interval)), METRICS["OC"]))
    assert axes.get_xlabel() == label
    assert max(xs(line).max() for line in axes.lines[:4]) == end


def test_axes_carry_units_and_thresholds_their_values(study: Study) -> None:
    figure = draw_time_series(over(study, TimeAxis("none")), METRICS["OC"])
    axes = only_axes(figure)
    assert axes.get_ylabel() == "Obstacle clearance [m]"
    levels = {float(ys(line)[0]): str(line.get_linestyle()) for line in axes.lines if ys(line).size == 2}
    assert levels == {0.2: "--", 0.5: ":"}
    places = {text.get_text().strip(): text.xy for text in axes.texts if isinstance(text, Annotation)}
    assert places == {"collision threshold 0.2 m": (1.0, 0.2), "min safe clearance 0.5 m": (0.0, 0.5)}


def test_rows_stand_behind_the_curve_only_where_they_do_not_hide_each_other(
    study: Study,
) -> None:
    def lines(members: int, code: str = "OC") -> list[Line2D]:
        few = Study(study.members[:members], study.groups, study.options)
        return list(only_axes(draw_time_series(over(few, TimeAxis("none")), METRICS[code])).lines)

    assert [len(lines(members)) for members in (2, 3, 4)] == [2 * 2 + 2, 3 * 2 + 2, 4 + 2]
    assert len(lines(2, "TC")) == 2
    values = study.members[0].log.columns["Obstacle Clearance"]
    np.testing.assert_array_equal(ys(lines(2)[0]), values)
    assert (lines(2)[0].get_alpha(), lines(2)[1].get_alpha()) == (0.3, None)


def test_a_metric_without_values_gives_no_figure(study: Study) -> None:
    assert draw_time_series(over(study, TimeAxis("none")), METRICS["VR"]) is None


def test_an_episode_without_a_value_draws_nothing(make_log: MakeLog) -> None:
    """A counter in one row has no rate, so that no interval of it has a mean."""
    study = one_column(make_log, "Distance Traveled", np.array([0, 1, 2, 0]))
    axes = only_axes(draw_time_series(over(study, TimeAxis("fixed_interval")), METRICS["DT"]))
    assert [ys(line).tolist() for line in axes.lines] == [[60.0, 60.0], []]


def test_a_single_jolt_does_not_set_the_axis_and_is_told(make_log: MakeLog) -> None:
    column = np.full(1000, 10.0)
    column[500] = 427.0
    study = one_column(make_log, "IMU Acceleration Magnitude", column)
    figure = draw_time_series(over(study, TimeAxis("none")), METRICS["IM"])
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


def test_a_short_series_is_drawn_whole_and_a_long_one_by_extremes_in_turn() -> None:
    x = np.arange(float(MOST_POINTS + 1))
    values = np.tile([3.0, np.nan], MOST_POINTS)[: MOST_POINTS + 1]
    assert [part.size for part in thinned(x, values)] == [MOST_POINTS // 2 + 1] * 2
    values = np.random.default_rng(0).normal(size=MOST_POINTS + 1)
    assert thinned(x[:-1], values[:-1])[0].size == MOST_POINTS
    runs = np.split(values, range(3, values.size, 3))
    extremes = sorted(3 * i + pick(run) for i, run in enumerate(runs) for pick in (np.argmin, np.argmax))
    assert thinned(x, values)[0].tolist() == np.unique(extremes).tolist()


def test_a_very_long_series_is_smoothed_over_the_means_of_runs() -> None:
    values = np.random.default_rng(0).normal(size=40_001)
    values[:3] = np.nan
    x, curve = smoothed(np.arange(40_001.0), values, 0.0, "mean")
    assert x[:2].tolist() == [1.0, 4.0]  # 13 334 runs of three
    assert curve.size == 13_334
    means = pd.Series(values).groupby(np.arange(40_001) // 3).mean()
    assert curve[20:30] == pytest.approx(means.rolling(9, center=True).mean()[20:30])
    assert smoothed(np.arange(20_000.0), values[:20_000], 0.0, "mean")[0].size == 20_000


@pytest.mark.parametrize(
    ("values", "at_least", "expected"),
    [
        ([], 0.0, (1.0, 0, 0.0)),
        ([np.nan], 2.0, (2.0, 0, 0.0)),
        ([0.0, 0.0], 0.0, (1.0, 0, 0.0)),
        ([1.0, 2.0], 0.0, (2.2, 0, 2.0)),
        ([1.0, 2.0], 3.0, (3.0, 0, 2.0)),
        ([*[1.0] * 999, 1.5], 0.0, (1.65, 0, 1.5)),
        ([*[1.0] * 998, 1.6, 1.6], 0.0, (1.1, 2, 1.6)),
        ([*[0.0] * 999, 5.0], 0.0, (5.5, 0, 5.0)),
    ],
)
def test_an_axis_ends_above_the_bulk(
    values: list[float], at_least: float, expected: tuple[float, int, float]
) -> None:
    assert upper_limit([np.array(values)], at_least) == pytest.approx(expected)


def test_the_median_is_not_lifted_by_a_jolt_and_the_mean_counts_it() -> None:
    values = np.zeros(100)
    values[50] = 90.0
    for share, window in ((0.05, 9), (0.2, 20)):
        assert smoothed(np.arange(100.0), values, share, "median")[1].max() == 0.0
        mean = smoothed(np.arange(100.0), values, share, "mean")[1]
        assert mean.max() == pytest.approx(90 / window)


def test_an_aggregate_is_mean_and_t_interval_of_the_episodes() -> None:
    curves = np.array([[1.0, 1.0, np.nan], [2.0, 3.0, np.nan], [3.0, np.nan, np.nan]])
    mean, low, high = mean_and_band(curves, 0.95)
    np.testing.assert_allclose(mean, [2, 2, np.nan])
    half = 4.30265273 * 1 / np.sqrt(3)  # t of 2 degrees of freedom
    np.testing.assert_allclose(high, [2 + half, 3, np.nan])
    np.testing.assert_allclose(low, [2 - half, 1, np.nan])


def test_an_aggregate_has_a_panel_a_metric_and_a_curve_a_group(study: Study) -> None:
    figure = draw_aggregate(study)
    assert figure is not None
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "Collisions [scans/min]",
        "Obstacle clearance [m]",
        "Time on rough terrain [% of rows]",
    ]
    assert [axes.get_xlabel() for axes in figure.axes] == ["", *["Share of the episode [%]"] * 2]
    assert figure.get_suptitle() == "Mean of the episodes; band: 95 % t interval (range if under 3)"
    clearance = figure.axes[1]
    grid = np.arange(0.0, 101.0, 2.0)
    assert [line.get_label() for line in clearance.lines[:2]] == ["a (2 episodes)", "b (2 episodes)"]
    highest = []
    for group, line, band in zip("ab", clearance.lines, clearance.collections, strict=False):
        curves = []
        for member in study.members:
            if member.group == group:
                x, y = TimeAxis().place(
                    member.log.stamps, study.series(member.log, METRICS["OC"]).values
                )
                curves.append(on_grid(x, y, grid))
        np.testing.assert_array_equal(xs(line), grid)
        np.testing.assert_allclose(ys(line), np.mean(curves, axis=0))
        edges = np.asarray(band.get_paths()[0].vertices)
        assert (edges[:, 1].min(), edges[:, 1].max()) == (np.min(curves), np.max(curves))
        high = np.max(curves, axis=0)
        highest.append(max(1.4 * np.mean(curves, axis=0).max(), 1.1 * np.quantile(high, 0.97)))
    assert clearance.get_ylim() == pytest.approx((0, max(highest)))
    assert draw_aggregate(replace(study, options=Options((METRICS["VR"],)))) is None


@pytest.mark.parametrize(
    ("axis", "step", "last"),
    [
        (TimeAxis("none"), 199 / 60, 199.0),
        (TimeAxis("fixed_interval", 50.0), 50.0, 200.0),
        (TimeAxis("fixed_interval", 0.01), 199 / 2000, 199.0),
    ],
)
def test_episodes_are_averaged_on_steps_that_suit_the_longest(
    study: Study, axis: TimeAxis, step: float, last: float
) -> None:
    x = xs(only_axes(draw_aggregate(over(study, axis))).lines[0])
    assert (x[0], x[1], x[-1]) == (0, pytest.approx(step), pytest.approx(last))


def test_a_correlation_is_written_into_its_cell_below_the_diagonal() -> None:
    metrics = [METRICS[code] for code in ("TC", "OC", "CV", "RT")]
    items = [
        Correlation("TC", "OC", -0.63, 9, 9.0, p=0.001, p_holm=0.049),
        Correlation("OC", "RT", 0.61, 9, 9.0, p=0.0001),
        Correlation("TC", "RT", 0.9, 9, 9.0, p=0.001, p_holm=0.05),
    ]
    figure = draw_correlation(items, metrics, 0.05)
    axes = only_axes(figure)
    colours = mpl.colormaps["PuOr"]
    cells = {
        (p.get_x() + 0.5, p.get_y() + 0.5): p.get_facecolor()
        for p in axes.patches
        if isinstance(p, Rectangle)
    }
    # CV is in no pair: columns TC, OC, and rows OC, RT.
    assert cells == {(0, 1): colours(0.185), (1, 2): colours(0.805), (0, 2): (1.0, 1.0, 1.0, 1.0)}
    shown = {(t.get_position()[0], t.get_text()): t.get_color() for t in axes.texts}
    assert shown == {
        (0, "-0.63"): "white",
        (0, "0.049"): "white",
        (1, "+0.61"): "black",
        (1, "<0.001"): "black",
        (0, "+0.90"): "#666666",
        (0, "0.050"): "#666666",
    }
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["TC", "OC"]
    assert [tick.get_text() for tick in axes.get_yticklabels()] == [
        "Obstacle clearance  OC",
        "Time on rough terrain  RT",
    ]
    assert (axes.get_xlim(), axes.get_ylim()) == ((-0.5, 1.5), (2.5, 0.5))
    assert "white: p (Holm) of 0.05 or more" in axes.get_title(loc="left")
    assert draw_correlation((), metrics, 0.05) is None


def test_a_comparison_shows_each_log_as_a_point_and_the_verdict(study: Study) -> None:
    result = analyse(study)
    figure = draw_comparison(study, result)
    assert figure is not None
    axes = figure.axes[1]
    means = [study.observations(METRICS["OC"], group) for group in "ab"]
    for place, (line, values) in enumerate(zip(axes.lines, means, strict=True)):
        assert (xs(line).tolist(), ys(line).tolist()) == ([place - 0.15, place + 0.15], values.tolist())
    segments = [
        np.asarray(c.get_segments()[0]) for c in axes.collections if isinstance(c, LineCollection)
    ]
    for place, values in enumerate(means):
        mean, bar = segments[2 * place : 2 * place + 2]
        np.testing.assert_allclose(mean, [[place - 0.28, values.mean()], [place + 0.28, values.mean()]])
        interval = stats.t.interval(0.95, 1, values.mean(), stats.sem(values))
        np.testing.assert_allclose(bar, [[place + 0.28, interval[0]], [place + 0.28, interval[1]]])
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["a", "b"]
    assert axes.get_ylim() == pytest.approx((0, 2 * max(map(max, means))))
    clearance = next(item for item in result.comparisons if item.code == "OC")
    verdict = f"p = {clearance.p_holm:.3f}, g = {clearance.hedges_g:+.2f}"
    assert axes.get_title(loc="right") == verdict
    assert axes.get_title(loc="left") == "Obstacle clearance\n[m]"
    told = "Each point one log; line: mean, bar: 95 % t interval; p: Holm-adjusted"
    assert figure.get_suptitle().splitlines()[0] == told
    assert " ".join(figure.get_suptitle().splitlines()[1:]) == " ".join(result.notes)
    for p, title in ((0.0004, "p <0.001"), (None, "no test")):
        item = replace(clearance, p_holm=p, hedges_g=None)
        alone = replace(study, options=Options((METRICS["OC"],)))
        axes = only_axes(draw_comparison(alone, replace(result, comparisons=(item,))))
        assert axes.get_title(loc="right") == title


def test_without_groups_a_comparison_shows_the_logs_side_by_side(study: Study) -> None:
    alone = ungrouped(study)
    figure = draw_comparison(alone, analyse(alone))
    assert figure is not None
    rates, clearances, _ = figure.axes
    for place, member in enumerate(alone.members):
        dot, box = rates.lines[place], clearances.patches[place]
        assert isinstance(box, Rectangle)
        total = np.ptp(member.log.columns["Total Collisions"]) / member.log.duration * 60
        assert [*ys(dot), *xs(dot)] == pytest.approx([total, place])
        low, first, middle, third, high = np.percentile(
            member.log.columns["Obstacle Clearance"], [5, 25, 50, 75, 95]
        )
        assert [box.get_y(), box.get_height()] == pytest.approx([first, third - first])
        whisker, median = (
            np.asarray(c.get_segments()[0])  # type: ignore[attr-defined]
            for c in clearances.collections[2 * place : 2 * place + 2]
        )
        np.testing.assert_allclose(whisker, [[place, low], [place, high]])
        np.testing.assert_allclose(median, [[place - 0.25, middle], [place + 0.25, middle]])
    assert [tick.get_text() for tick in rates.get_xticklabels()] == ["1", "2", "3", "4"]
    assert figure.get_supxlabel() == "1: log 0    2: log 1    3: log 2    4: log 3"
    many = replace(alone, members=alone.members * 4, options=Options((METRICS["OC"],)))
    figure = draw_comparison(many, analyse(alone))
    ticks = only_axes(figure).get_xticklabels()
    assert [tick.get_text() for tick in ticks] == [str(number) for number in range(1, 16, 2)]
    assert figure is not None
    assert figure.get_supxlabel().split("    ")[-1] == "and so on"
    assert "11: log 2" in figure.get_supxlabel()


@pytest.mark.parametrize(
    ("names", "columns"),
    [([], 1), (["a"], 1), (["abc"] * 9, 8), (["x" * 100, "a"], 1), (["x" * 11] * 9, 5)],
)
def test_a_legend_is_as_wide_as_the_figure(names: list[str], columns: int) -> None:
    assert legend_columns(names) == columns


@pytest.mark.parametrize("version", [(3, 6, 3), mpl.__version_info__])
@pytest.mark.parametrize("logs", [1, 12])
def test_a_legend_stands_between_the_axes_and_the_edge_of_the_figure(
    study: Study, monkeypatch: pytest.MonkeyPatch, logs: int, version: tuple[int, int, int]
) -> None:
    """Also without the "outside" of matplotlib 3.7, which Ubuntu 22.04 and 24.04 do not have."""
    monkeypatch.setattr(mpl, "__version_info__", version)
    log = study.members[0].log
    members = tuple(Member(log, f"a log with a long name, {number}", "all") for number in range(logs))
    with mpl.rc_context(STYLE):
        figure = draw_time_series(Study(members, ("all",), study.options), METRICS["OC"])
        assert figure is not None
        figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    axes = figure.axes[0].get_tightbbox()
    assert axes is not None
    assert 0 <= legend.y0 < legend.y1 <= axes.y0
    assert 0 <= legend.x0 < legend.x1 <= figure.bbox.x1
    assert axes.y0 - legend.y1 < 0.15 * figure.bbox.y1
    assert axes.y1 - axes.y0 > 0.4 * figure.bbox.y1


def test_a_dollar_in_a_name_is_a_dollar(
    study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Figure, "savefig", lambda *_, **__: None)
    first = replace(study.members[0], label="$x$", group="$a$")
    alone = Study((first,), ("$a$",), study.options)
    for figure in (
        draw_time_series(alone, METRICS["OC"]),
        draw_aggregate(alone),
        draw_comparison(alone, analyse(alone)),
    ):
        assert figure is not None
        save(figure, tmp_path, "plot")
        figure.draw_without_rendering()
        named = [text for text in figure.findobj(Text) if "$" in text.get_text()]
        assert named
        assert not any(text.get_parse_math() for text in named)


def test_files_are_png_and_pdf_and_the_same_bytes_again(study: Study, tmp_path: Path) -> None:
    written = []
    for folder in (tmp_path / "a", tmp_path / "b"):
        folder.mkdir()
        with mpl.rc_context(STYLE):
            figure = draw_time_series(over(study, TimeAxis("none")), METRICS["OC"])
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
    first = study.members[0]
    told = Member(replace(first.log, thresholds=had), first.label, "all")
    clearance, axis = METRICS["OC"], TimeAxis("none")
    alone = Study((told,), ("all",), study.options)
    for figure in (
        draw_time_series(over(alone, axis), clearance),
        draw_aggregate(replace(alone, options=Options((clearance,), axis=axis))),
        draw_comparison(replace(alone, options=Options((clearance,))), analyse(alone)),
    ):
        axes = only_axes(figure)
        levels = [ys(line)[0] for line in axes.get_lines() if list(xs(line)) == [0, 1]]
        assert levels == [0.3, 0.9]
        assert "collision threshold 0.3 m" in " ".join(text.get_text() for text in axes.texts)


def test_the_lowest_row_of_each_of_several_logs_is_marked(study: Study) -> None:
    axes = only_axes(draw_time_series(over(ungrouped(study), TimeAxis("none")), METRICS["OC"]))
    marks = [np.asarray(mark.get_offsets())[0].tolist() for mark in axes.collections]
    clearances = [member.log.columns["Obstacle Clearance"] for member in study.members]
    assert marks == [[int(np.argmin(c)), c.min()] for c in clearances]
    assert [to_hex(np.asarray(mark.get_facecolor())[0]) for mark in axes.collections] == OKABE_ITO[:4]
    alone = replace(ungrouped(study), members=study.members[:1])
    axes = only_axes(draw_time_series(over(alone, TimeAxis("none")), METRICS["OC"]))
    assert not axes.collections
    assert "lowest" not in axes.get_title(loc="left")
    assert not only_axes(draw_time_series(ungrouped(study), METRICS["TC"])).collections


@pytest.mark.parametrize(
    ("lowest", "highest", "begins"),
    [
        (0.0, 10.0, 0.0),
        (9.0, 10.0, 8.9),
        (5.0, 10.0, 0.0),
        (6.0, 10.0, 5.6),
        (10.0, 10.0, 0.0),
        (-1.0, 1.0, -1.2),
        (-3.0, -1.0, -3.2),
    ],
)
def test_an_axis_begins_at_0_unless_that_hides_the_difference(
    lowest: float, highest: float, begins: float
) -> None:
    assert lower_end(lowest, highest) == pytest.approx(begins)


def test_what_gravity_is_a_part_of_is_compared_from_where_it_differs(make_log: MakeLog) -> None:
    levels = [np.array([mean - 0.01, mean, mean + 0.01]) for mean in (9.80, 9.85, 9.95, 10.0)]
    name = "IMU Acceleration Magnitude"
    groups = one_column(make_log, name, *levels, groups="aabb")
    bottom, top = only_axes(draw_comparison(groups, analyse(groups))).get_ylim()
    assert (bottom, top) == pytest.approx((9.6, 10.2))
    alone = one_column(make_log, name, *levels)
    axes = only_axes(draw_comparison(alone, analyse(alone)))
    assert 9.7 < axes.get_ylim()[0] < 9.79
    assert 10.01 < axes.get_ylim()[1] < 10.1
    assert not axes.texts  # the threshold of 15 lies beyond
    rates = one_column(make_log, "Smoothness Metric", *(k * np.arange(9.0) for k in (240, 250)))
    assert only_axes(draw_comparison(rates, analyse(rates))).get_ylim()[0] == pytest.approx(14_340)


def test_negative_values_are_seen_in_every_plot(make_log: MakeLog) -> None:
    slip = np.tile([-0.5, 0.25, 0.0], 30)
    for logs, groups in (
        ((slip,), ""),
        ((slip, slip - 1), ""),
        ((slip, slip, slip - 1, slip - 2), "aabb"),
    ):
        drawn = one_column(make_log, "Slip", *logs, groups=groups)
        for figure in (
            draw_time_series(drawn, other_metric("Slip")),
            draw_aggregate(drawn),
            draw_comparison(drawn, analyse(drawn)),
        ):
            axes = only_axes(figure)
            ends = [float(value) for line in axes.lines for value in ys(line) if np.isfinite(value)]
            bottom, top = axes.get_ylim()
            assert all(bottom <= end <= top for end in ends)
    below = one_column(make_log, "Slip", np.array([*[-0.1] * 999, -9.0]))
    figure = draw_time_series(below, other_metric("Slip"))
    assert figure is not None
    assert "1 value below the axis, the lowest -9" in texts(figure)
    assert only_axes(figure).get_ylim() == pytest.approx((-0.11, 0.0))


def test_a_metric_without_values_leaves_the_layout_as_it_is(make_log: MakeLog) -> None:
    columns = {"Total Collisions": np.ones(9), "Obstacle Clearance": np.full(9, np.nan)}
    members = tuple(Member(make_log(columns), name, name) for name in "ab")
    options = Options(tuple(METRICS[code] for code in ("TC", "OC")))
    study = Study(members, ("a", "b"), options)
    figure = draw_comparison(study, analyse(study))
    assert figure is not None
    figure.draw_without_rendering()
    assert all(axes.get_position().width > 0.35 for axes in figure.axes)


def test_pairs_are_joined(study: Study) -> None:
    paired = replace(study, pairs=((0, 1), (1, 0)))
    figure = draw_comparison(paired, analyse(paired))
    assert figure is not None
    clearance = figure.axes[1]
    a, b = (study.observations(METRICS["OC"], group) for group in "ab")
    assert [ys(line).tolist() for line in clearance.lines[:2]] == [[a[0], b[1]], [a[1], b[0]]]
    assert "grey: pairs" in figure.get_suptitle()


def test_only_the_first_of_many_metrics_have_a_panel(make_log: MakeLog) -> None:
    columns = {f"c{i}": np.random.default_rng(i).random(20) for i in range(18)}
    metrics = tuple(map(other_metric, columns))
    study = Study((Member(make_log(columns), "x", "all"),), ("all",), Options(metrics))
    figure, panels, remark = metric_grid(study, ["c17", "c3"])
    assert (len(panels), remark) == (16, " (the first 16 of 18 metrics)")
    order = [metric.code for metric, _ in panels]
    assert order.index("c17") < order.index("c3")
    assert [axes.get_title(loc="left") for axes in figure.axes] == order
    long = replace(study, options=Options((other_metric("c1"), replace(metrics[0], title="x" * 80))))
    assert len(metric_grid(long)[0].axes[1].get_title(loc="left")) == 44


def test_a_large_matrix_of_correlations_names_columns_upright_and_writes_no_number() -> None:
    metrics = [METRICS["OC"], *(other_metric(f"Some Column {i} [m]") for i in range(14))]
    found = [Correlation(metrics[0].code, each.code, 0.5, 9, 9.0, p=0.001) for each in metrics[1:]]
    axes = only_axes(draw_correlation(found, metrics, 0.05))
    assert not axes.texts
    assert [tick.get_rotation() for tick in axes.get_xticklabels()] == [90] * 14
    assert [tick.get_text() for tick in axes.get_xticklabels()][:2] == ["OC", "Some Column 0"]
    assert axes.get_yticklabels()[0].get_text() == "Some Column 0"
    assert only_axes(draw_correlation(found[:13], metrics, 0.05)).texts
