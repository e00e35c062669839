"""The tables that people read, from a result."""

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet

from rich import box
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from rover_metrics.analysis.metric import METRICS
from rover_metrics.analysis.result import LogResult, Result
from rover_metrics.analysis.statistics.summary import Interval, Summary

_WIDE = 120  # columns of a terminal; a narrower one shows less, JSON everything

NONE = "–"  # noqa: RUF001  # an en dash, which no minus sign looks like in a column of numbers


def report(result: Result, width: int) -> Iterator[RenderableType]:
    """Yields everything there is to read of a result, on a terminal of so many columns."""
    for log in result.logs:
        yield from _log_tables(result, log, width)
    if len(result.logs) > 1:
        yield from _across_tables(result, width)
    if result.correlations:
        yield from _correlation_table(result)
    if result.comparisons:
        yield from _comparison_tables(result, width)


def _log_tables(result: Result, log: LogResult, width: int) -> Iterator[RenderableType]:
    """One log: what was odd, then its statistics."""
    episodes = f", {log.episodes} episodes" if log.episodes > 1 else ""
    group = f" ({log.group})" if len(result.groups) > 1 else ""
    rows = "1 row" if log.rows == 1 else f"{log.rows} rows"
    yield Text(f"\n{log.label}{group}: {rows}, {log.duration:.10g} s{episodes}", style="bold")
    for finding in log.findings:
        yield Text(f"  odd: {finding}", style="yellow")
    yield _statistics(result, log, width)


def _statistics(result: Result, log: LogResult, width: int) -> Table:
    level = _level(result)
    removed = "removed" if result.outliers_removed else "kept"
    rows = {
        code: {
            "Mean": number(summary.mean),
            f"{level} rows": _interval(summary.interval),
            f"{level} blocks": _interval(summary.bootstrap_interval),
            **_spread(summary),
            "n": str(summary.n),
            "n eff.": _formatted(summary.n_effective, ".0f"),
            f"Outliers {removed}": str(log.outliers[code]),
            "Per metre": number(log.per_metre.get(code)),
        }
        for code, summary in log.metrics.items()
    }
    table = _metric_table(
        rows, width, {f"{level} rows", "Median", "n", f"Outliers {removed}", "Per metre"}
    )
    table.caption = (
        f"{level} rows: interval of the mean as if rows were independent (t; shares: Wilson). "
        f"{level} blocks: by block bootstrap, the one to quote, for rows repeat each other: n of them "
        "say as much as n eff. independent ones. "
        f"Outliers: beyond {result.iqr_multiplier:g} interquartile ranges, {removed}."
    )
    return table


def _across_tables(result: Result, width: int) -> Iterator[RenderableType]:
    """All logs: the spread of their means."""
    for group, summaries in result.across.items():
        of_group = f" of {group}" if len(result.groups) > 1 else ""
        yield Text(f"\nAcross the logs{of_group}, each one observation", style="bold")
        rows = {
            code: {
                "Mean of means": number(summary.mean),
                f"{_level(result)} t": _interval(summary.interval),
                **_spread(summary),
                "Logs": str(summary.n),
            }
            for code, summary in summaries.items()
        }
        yield _metric_table(rows, width, {"Median"})


def _correlation_table(result: Result) -> Iterator[RenderableType]:
    """The correlations of all pairs, strongest first."""
    yield Text("\nCorrelation within logs, strongest first", style="bold")
    table = _table("Pair", ["rho", "p", "p (Holm)", "n", "n eff."])
    for item in sorted(result.correlations, key=lambda item: -abs(item.rho)):
        cells = (
            probability(item.p),
            probability(item.p_holm),
            str(item.n),
            _formatted(item.n_effective, ".0f"),
        )
        table.add_row(f"{item.first} - {item.second}", f"{item.rho:+.2f}", *cells)
    yield table
    yield Text(
        "Spearman's rank correlation; p from t with n eff. pairs in place of n (Pyper & Peterman 1998); "
        "several logs combined by Fisher's z; Holm: adjusted for the number of pairs.",
        style="dim",
    )


def _comparison_tables(result: Result, width: int) -> Iterator[RenderableType]:
    """The second group against the first."""
    first, second = result.groups
    yield Text(f"\n{second} against {first}, each {result.unit} one observation", style="bold")
    rows = {
        item.code: {
            f"{first} mean": number(item.means[0]),
            f"{second} mean": number(item.means[1]),
            "Difference": number(item.difference),
            _level(result): _interval(item.interval),
            "p": probability(item.p),
            "p (Holm)": probability(item.p_holm),
            "g": _formatted(item.hedges_g, "+.2f"),
            "delta": _formatted(item.cliffs_delta, "+.2f"),
            "n": f"{item.n[0]} + {item.n[1]}",
        }
        for item in result.comparisons
    }
    table = _metric_table(rows, width, {"Difference", "p", "delta", "n"})
    table.caption = _how_compared(result)
    yield table


def _how_compared(result: Result) -> str:
    tests = sorted({item.test for item in result.comparisons if item.test is not None})
    if not tests:
        return f"No test: it needs two {result.unit}s or more in each group."
    smallest = max((item.smallest_p or 0.0) for item in result.comparisons)
    warning = ""
    if smallest > 1 - result.confidence:
        warning = f" So few {result.unit}s cannot give a p below {smallest:.2g}: add some."
    return (
        f"p: {' and '.join(tests)}, two-sided. Interval: Welch. g: Hedges' standardised difference. "
        f"delta: Cliff's, -1 to 1. Holm: adjusted for the number of metrics.{warning}"
    )


def number(value: float | None) -> str:
    """Returns four significant digits, never in powers of ten."""
    if value is None:
        return NONE
    if value == 0:
        return "0"
    digits = 4 - len(str(int(abs(value)))) if abs(value) >= 1 else 4
    return f"{value:.{max(digits, 0)}f}"


def probability(p: float | None) -> str:
    """Returns a p-value as papers print it."""
    if p is None:
        return NONE
    return "<0.001" if p < 0.001 else f"{p:.3f}"


def _interval(interval: Interval | None) -> str:
    return NONE if interval is None else f"{number(interval[0])} to {number(interval[1])}"


def _formatted(value: float | None, form: str) -> str:
    return NONE if value is None else format(value, form)


def _spread(summary: Summary) -> dict[str, str]:
    return {
        "Median": number(summary.median),
        "SD": number(summary.sd),
        "Min": number(summary.minimum),
        "Max": number(summary.maximum),
    }


def _level(result: Result) -> str:
    return f"{100 * result.confidence:g} %"


def _metric_table(rows: Mapping[str, Mapping[str, str]], width: int, spare: AbstractSet[str]) -> Table:
    """Lays out one row a metric; a narrow terminal gets it without the spare columns."""
    titles = next(iter(rows.values()), {})
    shown = [title for title in titles if width >= _WIDE or title not in spare]
    table = _table("Metric", shown)
    for code, cells in rows.items():
        name = Text.assemble((f"{code:<4}", "bold"), f" {METRICS[code].label}")
        table.add_row(name, *(cells[title] for title in shown))
    return table


def _table(first: str, others: Sequence[str]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left", caption_style="dim", pad_edge=False)
    table.add_column(first, min_width=12)
    for title in others:
        table.add_column(Text(title), justify="right", no_wrap=True)
    return table
