"""The tables of a result that people read, on a terminal or in LaTeX."""

from collections.abc import Iterator, Mapping
from typing import Any

from rover_metrics.analysis.outcome import LogResult, Result
from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.summary import Summary
from rover_metrics.errors import counted
from rover_metrics.sheet.sheet import Sheet, formatted, interval_text, number, probability


def sheets(result: Result) -> Iterator[Sheet]:
    """Yields everything there is to read of a result."""
    for place, log in enumerate(result.logs, 1):
        yield _statistics(result, log, place)
    if len(result.logs) > 1:
        for place, (group, summaries) in enumerate(result.across.items(), 1):
            yield _across(result, group, summaries, place)
    if result.correlations:
        yield _correlations(result)
    if result.comparisons:
        yield _comparisons(result)


def _of_metrics(
    result: Result,
    cells: Mapping[str, Mapping[str, str]],
    title: str,
    caption: str = "",
    **about: Any,  # noqa: ANN401 - attributes of a Sheet
) -> Sheet:
    """Returns a table with a row per metric, from its cells by code."""
    rows = [{"Metric": result.titles[code], **row} for code, row in cells.items()]
    # The code of a column is its name, which its title says already.
    codes = ("" if c.startswith(result.titles[c].partition(" [")[0]) else c for c in cells)
    return Sheet.of(rows, title, caption=caption, codes=tuple(codes), **about)


def _statistics(result: Result, log: LogResult, place: int) -> Sheet:
    """Returns the statistics of one log, and what was odd about it."""
    level, removed = _level(result), "removed" if result.outliers_removed else "kept"
    episodes = f", {log.episodes} episodes" if log.episodes > 1 else ""
    group = f" ({log.group})" if len(result.groups) > 1 else ""
    cells = {
        code: {
            "Mean": number(summary.mean),
            f"{level} rows": interval_text(summary.interval),
            f"{level} blocks": interval_text(summary.bootstrap_interval),
            **_spread(summary),
            "n": str(summary.n),
            "n eff.": formatted(summary.n_effective, ".0f"),
            f"Outliers {removed}": str(log.outliers[code]),
            "Per metre": number(log.per_metre.get(code)),
        }
        for code, summary in log.metrics.items()
    }
    return _of_metrics(
        result,
        cells,
        f"{log.label}{group}: {counted(log.rows, 'row')}, {log.duration:.10g} s{episodes}",
        f"{level} rows: interval of the mean as if rows were independent (t; shares: Wilson). "
        f"{level} blocks: by block bootstrap, the one to quote, for rows repeat each other: n of them "
        "say as much as n eff. independent ones. "
        f"Outliers: beyond {result.iqr_multiplier:g} interquartile ranges, {removed}.",
        findings=log.findings,
        spare=frozenset({f"{level} rows", "Median", "n", f"Outliers {removed}", "Per metre"}),
        file=f"log_{place}",
    )


def _across(result: Result, group: str, summaries: Mapping[str, Summary], place: int) -> Sheet:
    """Returns the spread of the means of a group's logs."""
    of_group = f" of {group}" if len(result.groups) > 1 else ""
    cells = {
        code: {
            "Mean of means": number(summary.mean),
            f"{_level(result)} t": interval_text(summary.interval),
            **_spread(summary),
            "Logs": str(summary.n),
        }
        for code, summary in summaries.items()
    }
    title = f"Across the logs{of_group}, each one observation"
    return _of_metrics(result, cells, title, spare=frozenset({"Median"}), file=f"across_{place}")


def _correlations(result: Result) -> Sheet:
    """Returns the correlations of all pairs, strongest first."""
    rows = (
        {
            "Pair": f"{item.first} - {item.second}",
            "rho": f"{item.rho:+.2f}",
            "p": probability(item.p),
            "p (Holm)": probability(item.p_holm),
            "n": str(item.n),
            "n eff.": formatted(item.n_effective, ".0f"),
        }
        for item in sorted(result.correlations, key=lambda item: -abs(item.rho))
    )
    return Sheet.of(
        rows,
        "Correlation within logs, strongest first",
        caption="Spearman's rank correlation; p from t with n eff. pairs in place of n (Pyper & "
        "Peterman 1998); several logs combined by Fisher's z; Holm: adjusted for the number of pairs.",
        file="correlation",
    )


def _comparisons(result: Result) -> Sheet:
    """Returns the second group against the first."""
    first, second = result.groups
    each = f"each pair of {result.unit}s" if result.comparisons[0].paired else f"each {result.unit}"
    return _of_metrics(
        result,
        {item.code: _compared(result, item) for item in result.comparisons},
        f"{second} against {first}, {each} one observation",
        _how_compared(result),
        spare=frozenset({"Difference", "p", "delta", "n"}),
        file="comparison",
    )


def _compared(result: Result, item: Comparison) -> dict[str, str]:
    first, second = result.groups
    return {
        f"{first} mean": number(item.means[0]),
        f"{second} mean": number(item.means[1]),
        "Difference": number(item.difference),
        _level(result): interval_text(item.interval),
        "p": probability(item.p),
        "p (Holm)": probability(item.p_holm),
        "g": formatted(item.hedges_g, "+.2f"),
        "delta": formatted(item.cliffs_delta, "+.2f"),
        "n": counted(item.n[0], "pair") if item.paired else f"{item.n[0]} + {item.n[1]}",
    }


def _how_compared(result: Result) -> str:
    tests = sorted({item.test for item in result.comparisons if item.test is not None})
    notes = " ".join(result.notes)
    if not tests:
        return notes
    interval = "Student's, of the differences" if result.comparisons[0].paired else "Welch"
    return (
        f"p: {' and '.join(tests)}, two-sided. Interval: {interval}. g: Hedges' standardised "
        "difference. delta: Cliff's, -1 to 1. Holm: adjusted for the number of metrics. "
        f"{notes}"
    ).strip()


def _spread(summary: Summary) -> dict[str, str]:
    return {
        "Median": number(summary.median),
        "SD": number(summary.sd),
        "Min": number(summary.minimum),
        "Max": number(summary.maximum),
    }


def _level(result: Result) -> str:
    return f"{100 * result.confidence:g} %"
