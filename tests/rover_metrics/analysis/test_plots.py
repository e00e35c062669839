from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from rover_metrics.analysis.logs.log import Floats, Log, TimeAxis
from rover_metrics.analysis.metric import METRICS, other_metric
from rover_metrics.analysis.outcome import analyse
from rover_metrics.analysis.plots import time_series as series
from rover_metrics.analysis.plots.aggregate import draw_aggregate, mean_and_band
from rover_metrics.analysis.plots.comparison import draw_comparison
from rover_metrics.analysis.plots.correlation import draw_correlation
from rover_metrics.analysis.plots.style import STYLE, legend_columns, look, lower_end, save
from rover_metrics.analysis.plots.time_series import MOST_POINTS, draw_time_series, thinned
from rover_metrics.analysis.statistics.correlation import Correlation
from rover_metrics.analysis.study import Options, Study
from rover_metrics.core.thresholds import Thresholds
from tests.support.figures import described
from tests.support.snapshots import check_snapshot

MakeLog = Callable[..., Log]


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
    named = [replace(log, label=f"log {i}", group="ab"[i // 2]) for i, log in enumerate(logs)]
    metrics = tuple(METRICS[code] for code in ("TC", "OC", "RT"))
    return Study(tuple(named), ("a", "b"), Options(metrics, plots=("correlation",)))


def one_column(make_log: MakeLog, name: str, *logs: Floats, groups: str = "") -> Study:
    """A study of one column, a log each; in groups as their letters say."""
    metric = next((m for m in METRICS.values() if m.column == name), None) or other_metric(name)
    letters = groups or "a" * len(logs)
    made = enumerate(make_log({name: log}) for log in logs)
    named = [replace(log, label=f"log {i}", group=letters[i]) for i, log in made]
    return Study(tuple(named), tuple(sorted(set(letters))), Options((metric,), plots=("correlation",)))


def studies(study: Study, make_log: MakeLog) -> Iterator[tuple[str, Study]]:
    """Yields what is drawn in all ways, by what it shows."""
    alone = replace(study, logs=tuple(replace(log, group="all") for log in study.logs), groups=("all",))
    clearance, rows = Options((METRICS["OC"],)), TimeAxis("none")
    jolt = np.where(np.arange(1000) == 500, 427.0, 10.0)
    levels = [np.array([mean - 0.01, mean, mean + 0.01]) for mean in (9.80, 9.85, 9.95, 10.0)]
    slip, shaking = np.tile([-0.5, 0.25, 0.0], 30), "IMU Acceleration Magnitude"
    had = Thresholds(collision_threshold=0.3, min_safe_clearance=0.9)
    first, second = study.logs[:2]
    of_had = (replace(first, thresholds=had), second)
    yield "two groups", study
    yield "one group", replace(alone, options=replace(study.options, axis=rows))
    yield "pairs", replace(study, pairs=((0, 1), (1, 0)))
    for count, width in ((2, 50.0), (1, 0.01)):
        means = replace(clearance, axis=TimeAxis("fixed_interval", width))
        name = f"{count} logs, means of {width} s"
        yield name, replace(alone, logs=alone.logs[:count], options=means)
    for count in (12, 13, 16):
        many = tuple(replace(first, label=f"log {i}", group="all") for i in range(count))
        yield f"{count} logs", replace(alone, logs=many, options=clearance)
    yield "a metric that no log has", replace(study, options=Options((METRICS["VR"],)))
    own = replace(study, logs=of_had, groups=("a",), options=clearance)
    yield "logs with thresholds of their own", own
    yield "always rough", one_column(make_log, "Is Rough Terrain", np.ones(50))
    yield "an episode of one row", one_column(make_log, "Distance Traveled", np.array([0, 1, 2, 0]))
    yield "a jolt", one_column(make_log, shaking, jolt)
    yield "a dip below zero", one_column(make_log, "Slip", np.where(jolt > 10, -9.0, -0.1))
    yield "gravity in two groups", one_column(make_log, shaking, *levels, groups="aabb")
    yield "gravity in four logs", one_column(make_log, shaking, *levels)
    yield "negative values of two logs", one_column(make_log, "Slip", slip, slip - 1)
    four = one_column(make_log, "Slip", slip, slip, slip - 1, slip - 2, groups="aabb")
    yield "negative values in groups", four
    nothing = {"Total Collisions": np.ones(9), "Obstacle Clearance": np.full(9, np.nan)}
    empty = tuple(replace(make_log(nothing), label=name, group=name) for name in "ab")
    yield "no value", Study(empty, ("a", "b"), Options(tuple(METRICS[code] for code in ("TC", "OC"))))
    columns = {f"c{i}": np.random.default_rng(i).random(20) for i in range(18)}
    titled = (replace(other_metric("c0"), title="x" * 80), *map(other_metric, list(columns)[1:]))
    log = replace(make_log(columns), label="x", group="all")
    yield "18 metrics", Study((log,), ("all",), Options(titled, plots=("correlation",)))


def test_figures_are_as_somebody_has_checked(study: Study, make_log: MakeLog) -> None:
    parts: list[str] = []
    for name, drawn in studies(study, make_log):
        result, metrics = analyse(drawn), drawn.options.metrics
        figures = {f"{each.code} over time": draw_time_series(drawn, each) for each in metrics[:3]}
        figures["aggregate"] = draw_aggregate(drawn)
        figures["comparison"] = compared = draw_comparison(drawn, result)
        if len(metrics) > 1:
            figures["correlation"] = draw_correlation(result.correlations, metrics, 0.05)
        parts += [f"== {name}, {kind}\n{described(figure)}" for kind, figure in figures.items()]
        if name == "no value":
            assert compared is not None
            compared.draw_without_rendering()
            assert all(axes.get_position().width > 0.35 for axes in compared.axes)
    check_snapshot("figures.txt", "\n".join(parts))


def test_a_correlation_is_written_into_its_cell_below_the_diagonal() -> None:
    items = [
        Correlation("TC", "OC", -0.63, 9, 9.0, p=0.001, p_holm=0.049),
        Correlation("OC", "RT", 0.61, 9, 9.0, p=0.0001),
        Correlation("TC", "RT", 0.9, 9, 9.0, p=0.001, p_holm=0.05),
    ]
    metrics = [METRICS[code] for code in ("TC", "OC", "CV", "RT")]  # CV is in no pair
    check_snapshot("correlation.txt", described(draw_correlation(items, metrics, 0.05)))
    colour = mpl.colormaps["PuOr"](0.805)  # as a rho of +0.61 lies from -1 to 1
    (axes, _) = draw_correlation(items[1:2], metrics, 0.05).axes  # type: ignore[union-attr]
    assert isinstance(cell := axes.patches[0], Rectangle)
    assert (cell.get_facecolor(), cell.get_x(), cell.get_y()) == (colour, -0.5, 0.5)


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
    x, curve = series.smoothed(np.arange(40_001.0), values, 0.0, "mean")
    assert x[:2].tolist() == [1.0, 4.0]  # 13 334 runs of three
    assert curve.size == 13_334
    means = pd.Series(values).groupby(np.arange(40_001) // 3).mean()
    assert curve[20:30] == pytest.approx(means.rolling(9, center=True).mean()[20:30])
    assert series.smoothed(np.arange(20_000.0), values[:20_000], 0.0, "mean")[0].size == 20_000


def test_an_axis_ends_above_the_bulk_and_begins_at_0_unless_that_hides_the_difference() -> None:
    for values, at_least, expected in (
        ([0.0, 0.0], 0.0, (1.0, 0, 0.0)),
        ([1.0, 2.0], 0.0, (2.2, 0, 2.0)),
        ([1.0, 2.0], 3.0, (3.0, 0, 2.0)),
        ([*[1.0] * 999, 1.5], 0.0, (1.65, 0, 1.5)),
        ([*[1.0] * 998, 1.6, 1.6], 0.0, (1.1, 2, 1.6)),
        ([*[0.0] * 999, 5.0], 0.0, (5.5, 0, 5.0)),
    ):
        assert series.upper_limit(np.array(values), at_least) == pytest.approx(expected)
    ends = {(0, 10): 0, (9, 10): 8.9, (5, 10): 0, (6, 10): 5.6, (10, 10): 0}
    for (lowest, highest), begins in (ends | {(-1, 1): -1.2, (-3, -1): -3.2}).items():
        assert lower_end(lowest, highest) == pytest.approx(begins)
    assert len({str(look(i)) for i in range(30)}) == 30


def test_an_aggregate_is_mean_and_t_interval_of_the_episodes() -> None:
    curves = np.array([[1.0, 1.0, np.nan], [2.0, 3.0, np.nan], [3.0, np.nan, np.nan]])
    mean, low, high = mean_and_band(curves, 0.95)
    np.testing.assert_allclose(mean, [2, 2, np.nan])
    half = 4.30265273 * 1 / np.sqrt(3)  # t of 2 degrees of freedom
    np.testing.assert_allclose(high, [2 + half, 3, np.nan])
    np.testing.assert_allclose(low, [2 - half, 1, np.nan])


@pytest.mark.parametrize("version", [(3, 6, 3), mpl.__version_info__])
@pytest.mark.parametrize("logs", [1, 12])
def test_a_legend_stands_between_the_axes_and_the_edge_of_the_figure(
    study: Study, monkeypatch: pytest.MonkeyPatch, logs: int, version: tuple[int, int, int]
) -> None:
    """Also without the "outside" of matplotlib 3.7, which Ubuntu 22.04 and 24.04 do not have."""
    for names, columns in (([], 1), (["abc"] * 9, 8), (["x" * 100, "a"], 1), (["x" * 11] * 9, 5)):
        assert legend_columns(names) == columns
    monkeypatch.setattr(mpl, "__version_info__", version)
    names = [f"a log with a long name, {number}" for number in range(logs)]
    named = tuple(replace(study.logs[0], label=name, group="all") for name in names)
    with mpl.rc_context(STYLE):
        figure = draw_time_series(Study(named, ("all",), study.options), METRICS["OC"])
        assert figure is not None
        figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    axes = figure.axes[0].get_tightbbox()
    assert axes is not None
    assert 0 <= legend.y0 < legend.y1 <= axes.y0
    assert 0 <= legend.x0 < legend.x1 <= figure.bbox.x1
    assert axes.y0 - legend.y1 < 0.15 * figure.bbox.y1
    assert axes.y1 - axes.y0 > 0.4 * figure.bbox.y1


def test_a_dollar_is_a_dollar(study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Figure, "savefig", lambda *_, **__: None)
    first = replace(study.logs[0], label="$x$", group="$a$")
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
            figure = draw_time_series(study, METRICS["OC"])
            assert figure is not None
            written.append(save(figure, folder, "plot"))
    for first, second in zip(*written, strict=True):
        assert first.read_bytes() == second.read_bytes()
    assert written[0][0].read_bytes().startswith(b"\x89PNG")
    assert written[0][1].read_bytes().startswith(b"%PDF")
    assert imread(written[0][0]).shape[:2] == (720, 1440)
