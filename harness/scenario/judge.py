"""Bounds against what a quantity was: what a person is shown of a run that does not keep them."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.scenario.bound import Bound
from harness.scenario.series import Series

_WORDS = {"end": "at the end ", "mean": "mean ", "p95": "95th percentile "}


@dataclass(frozen=True)
class Breach:
    """An expectation that was not met.

    Attributes:
        reason: In one line, e.g. "truth.tilt_deg: 31.2 deg > 25 deg, first at 7.35 s".
        time_s: When it was first not met [s]; None if that is no matter of one snapshot.
    """

    reason: str
    time_s: float | None = None


class _Limit(NamedTuple):
    sign: str
    value: float
    broken: NDArray[np.bool_]


def judge(name: str, bound: Bound, series: Series) -> Breach | None:
    """Returns what is wrong with a quantity, None if nothing is.

    A NaN is no value: it keeps and breaks nothing. Where there is no value at all, nothing is kept.

    Args:
        name: Of the quantity.
        bound: What it must keep.
        series: What it was.
    """
    times, values = _within(bound, series)
    if series.is_tally:
        return _judge_tally(name, bound, times)
    if not len(values):
        return Breach(f"{name}: {series.nothing}{_window(bound)}")
    counted = Series(times, values, series.unit)
    if bound.over == "share":
        return _judge_share(name, bound, counted)
    if bound.over == "always":
        return _judge_always(name, bound, counted)
    value = _summed_up(bound, values)
    for limit in _limits(bound, np.array([value])):
        if limit.broken[0]:
            shown, allowed = _apart(float(value), limit.value, series)
            return Breach(f"{name}: {_WORDS[bound.over]}{shown} {limit.sign} {allowed}{_window(bound)}")
    return None


def judge_against(name: str, bound: Bound, series: Series, baseline: float | None) -> Breach | None:
    """Returns what is wrong with a quantity that is to be near its baseline, None if nothing is.

    Args:
        name: Of the quantity.
        bound: What it must keep.
        series: What it was.
        baseline: What `value_of` gave when the baseline was recorded.
    """
    value, allowed = value_of(bound, series), ""
    if value == baseline:
        return None
    if value is not None and baseline is not None:
        tolerance = bound.tolerance(baseline)
        if abs(value - baseline) <= tolerance:
            return None
        allowed = f", allowed +- {tolerance:.4g}{_unit(series)}"
    was, recorded = _apart(value, baseline, series)
    words = _WORDS[bound.over]
    return Breach(f"{name}: {words}{was}, baseline {recorded}{allowed}{_window(bound)}")


def value_of(bound: Bound, series: Series) -> float | None:
    """Returns what a quantity came to, in one value; None where there is no finite one.

    It is what the bound compares: of all values the one that lies farthest beyond a limit, or else
    nearest to one; of a share the share.
    """
    _, values = _within(bound, series)
    if series.is_tally:
        return float(len(values))
    value = float(_summed_up(bound, values)) if len(values) else math.nan
    return value if math.isfinite(value) else None


def _summed_up(bound: Bound, values: NDArray[np.float64]) -> np.float64:
    match bound.over:
        case "p95":  # a value that was there: between two infinite ones is none
            return np.float64(np.percentile(values, 95, method="inverted_cdf"))
        case "mean":
            return np.float64(values.mean())
        case "share":
            return np.float64(_share(bound, values))
        case "always":
            return _worst(bound, values)
    return np.float64(values[-1])


def _worst(bound: Bound, values: NDArray[np.float64]) -> np.float64:
    lowest, highest = values.min(), values.max()
    if bound.min is None:
        return np.float64(highest)
    if bound.max is None:
        return np.float64(lowest)
    return np.float64(lowest if lowest - bound.min <= bound.max - highest else highest)


def _share(bound: Bound, values: NDArray[np.float64]) -> float:
    broken = np.logical_or.reduce([limit.broken for limit in _limits(bound, values)])
    # 1 minus a share would miss 0.2 by a rounding.
    return int(np.count_nonzero(~broken)) / len(values)


def _within(bound: Bound, series: Series) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The values that count, with their times."""
    begin, end = bound.window or (-math.inf, math.inf)
    counts = (series.times >= begin) & (series.times <= end) & ~np.isnan(series.values)
    return series.times[counts], series.values[counts]


def _limits(bound: Bound, values: NDArray[np.float64]) -> list[_Limit]:
    limits = []
    if bound.min is not None:
        limits.append(_Limit("<", bound.min, ~(values >= bound.min)))
    if bound.max is not None:
        limits.append(_Limit(">", bound.max, ~(values <= bound.max)))
    return limits


def _judge_always(name: str, bound: Bound, series: Series) -> Breach | None:
    """Shows the worst value with its time, and the first breach's; the lower limit comes first."""
    for limit in _limits(bound, series.values):
        if limit.broken.any():
            worst = series.values.min() if limit.sign == "<" else series.values.max()
            first = float(series.times[limit.broken.argmax()])
            shown, allowed = _apart(float(worst), limit.value, series)
            worst_s = float(series.times[(series.values == worst).argmax()])
            when = "" if worst_s == first else f" at {worst_s:g} s"
            reason = f"{name}: {shown} {limit.sign} {allowed}{when}, first at {first:g} s"
            return Breach(reason, first)
    return None


def _judge_tally(name: str, bound: Bound, times: NDArray[np.float64]) -> Breach | None:
    """The number of values; of too many, the first that is one too many."""
    count = len(times)
    for limit in _limits(bound, np.array([float(count)])):
        if limit.broken[0]:
            shown = f"{name}: {count} {limit.sign} {limit.value:g}"
            if limit.sign == "<":
                return Breach(f"{shown}{_window(bound)}")
            first = float(times[max(0, math.floor(limit.value))])
            return Breach(f"{shown}, first at {first:g} s", first)
    return None


def _judge_share(name: str, bound: Bound, series: Series) -> Breach | None:
    kept = _share(bound, series.values)
    if bound.share is None or kept >= bound.share:
        return None
    limits = " to ".join(f"{limit:g}" for limit in (bound.min, bound.max) if limit is not None)
    side = "within" if None not in (bound.min, bound.max) else "above" if bound.max is None else "below"
    shown = f"{name}: {100 * kept:.3g} % of values {side} {limits}{_unit(series)}"
    return Breach(f"{shown}, {100 * bound.share:g} % expected{_window(bound)}")


def _apart(value: float | None, other: float | None, series: Series) -> tuple[str, str]:
    """Two unequal values in as few digits as tell them apart."""
    for digits in (4, 7, 17):
        texts = [f"{v:.{digits}g}" for v in (value, other) if v is not None]
        if len(set(texts)) == len(texts):
            break
    shown = iter(texts)
    first, second = ("no value" if v is None else next(shown) + _unit(series) for v in (value, other))
    return first, second


def _unit(series: Series) -> str:
    return f" {series.unit}" if series.unit else ""


def _window(bound: Bound) -> str:
    return "" if bound.window is None else f" between {bound.window[0]:g} and {bound.window[1]:g} s"
