"""What stands in the tables that people read, as text, whatever they are read on."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rover_metrics.analysis.result import LogResult, Result
from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.summary import Interval, Summary

NONE = "–"  # noqa: RUF001  # an en dash, which no minus sign looks like in a column of numbers


@dataclass(frozen=True)
class Row:
    """One line of a table: a metric's code (or nothing), what it is about, and its cells by title."""

    code: str
    name: str
    cells: Mapping[str, str]


@dataclass(frozen=True)
class Sheet:
    """One table.

    Attributes:
        file: Name of its file, without extension.
        title: Its heading.
        head: Title of the first column.
        rows: Its lines.
        caption: How its numbers were found.
        odd: What is odd about what it is drawn from.
        spare: Titles of the columns that a narrow page does without.
    """

    file: str
    title: str
    head: str
    rows: tuple[Row, ...]
    caption: str
    odd: tuple[str, ...] = ()
    spare: frozenset[str] = frozenset()

    def titles(self, *, narrow: bool) -> list[str]:
        """Returns the titles of the columns after the first."""
        every = self.rows[0].cells if self.rows else {}
        return [title for title in every if not narrow or title not in self.spare]


def sheets(result: Result) -> Iterator[Sheet]:
    """Yields everything there is to read of a result."""
    for number, log in enumerate(result.logs, 1):
        yield _statistics(result, log, number)
    if len(result.logs) > 1:
        for number, (group, summaries) in enumerate(result.across.items(), 1):
            yield _across(result, group, summaries, number)
    if result.correlations:
        yield _correlations(result)
    if result.comparisons:
        yield _comparisons(result)


def _row(result: Result, code: str, cells: Mapping[str, str]) -> Row:
    """Returns the row of a metric; the code of a column is its name, which its title says already."""
    title = result.titles[code]
    return Row("" if code.startswith(title.partition(" [")[0]) else code, title, cells)


def _statistics(result: Result, log: LogResult, number_of_log: int) -> Sheet:
    """Returns one log: what was odd, and its statistics."""
    level, removed = _level(result), "removed" if result.outliers_removed else "kept"
    rows = (
        _row(
            result,
            code,
            {
                "Mean": number(summary.mean),
                f"{level} rows": interval_text(summary.interval),
                f"{level} blocks": interval_text(summary.bootstrap_interval),
                **_spread(summary),
                "n": str(summary.n),
                "n eff.": _formatted(summary.n_effective, ".0f"),
                f"Outliers {removed}": str(log.outliers[code]),
                "Per metre": number(log.per_metre.get(code)),
            },
        )
        for code, summary in log.metrics.items()
    )
    return Sheet(
        f"log_{number_of_log}",
        _heading(result, log),
        "Metric",
        tuple(rows),
        f"{level} rows: interval of the mean as if rows were independent (t; shares: Wilson). "
        f"{level} blocks: by block bootstrap, the one to quote, for rows repeat each other: n of them "
        "say as much as n eff. independent ones. "
        f"Outliers: beyond {result.iqr_multiplier:g} interquartile ranges, {removed}.",
        log.findings,
        frozenset({f"{level} rows", "Median", "n", f"Outliers {removed}", "Per metre"}),
    )


def _heading(result: Result, log: LogResult) -> str:
    episodes = f", {log.episodes} episodes" if log.episodes > 1 else ""
    group = f" ({log.group})" if len(result.groups) > 1 else ""
    rows = "1 row" if log.rows == 1 else f"{log.rows} rows"
    return f"{log.label}{group}: {rows}, {log.duration:.10g} s{episodes}"


def _across(result: Result, group: str, summaries: Mapping[str, Summary], number_of_group: int) -> Sheet:
    """Returns the spread of the means of a group's logs."""
    of_group = f" of {group}" if len(result.groups) > 1 else ""
    rows = (
        _row(
            result,
            code,
            {
                "Mean of means": number(summary.mean),
                f"{_level(result)} t": interval_text(summary.interval),
                **_spread(summary),
                "Logs": str(summary.n),
            },
        )
        for code, summary in summaries.items()
    )
    title = f"Across the logs{of_group}, each one observation"
    file = f"across_{number_of_group}"
    return Sheet(file, title, "Metric", tuple(rows), "", spare=frozenset({"Median"}))


def _correlations(result: Result) -> Sheet:
    """Returns the correlations of all pairs, strongest first."""
    rows = (
        Row(
            "",
            f"{item.first} - {item.second}",
            {
                "rho": f"{item.rho:+.2f}",
                "p": probability(item.p),
                "p (Holm)": probability(item.p_holm),
                "n": str(item.n),
                "n eff.": _formatted(item.n_effective, ".0f"),
            },
        )
        for item in sorted(result.correlations, key=lambda item: -abs(item.rho))
    )
    return Sheet(
        "correlation",
        "Correlation within logs, strongest first",
        "Pair",
        tuple(rows),
        "Spearman's rank correlation; p from t with n eff. pairs in place of n (Pyper & Peterman 1998); "
        "several logs combined by Fisher's z; Holm: adjusted for the number of pairs.",
    )


def _comparisons(result: Result) -> Sheet:
    """Returns the second group against the first."""
    first, second = result.groups
    paired = result.comparisons[0].paired
    rows = (_row(result, item.code, _compared(result, item)) for item in result.comparisons)
    each = f"each pair of {result.unit}s" if paired else f"each {result.unit}"
    return Sheet(
        "comparison",
        f"{second} against {first}, {each} one observation",
        "Metric",
        tuple(rows),
        _how_compared(result),
        spare=frozenset({"Difference", "p", "delta", "n"}),
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
        "g": _formatted(item.hedges_g, "+.2f"),
        "delta": _formatted(item.cliffs_delta, "+.2f"),
        "n": f"{item.n[0]} pairs" if item.paired else f"{item.n[0]} + {item.n[1]}",
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


def interval_text(interval: Interval | None) -> str:
    """Returns both ends of an interval."""
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
