"""Bounds against what a quantity was: what a person is told of a run that does not keep them."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.scenario.quantities import Series
from harness.scenario.spec import Bound

_WORDS = {"end": "at the end ", "mean": "mean ", "p95": "95th percentile "}


@dataclass(frozen=True)
class Breach:
    """An expectation that was not met.

    Attributes:
        reason: In one line, e.g. "truth.tilt_deg: 31.2 deg > 25 deg, first at 7.35 s".
        time_s: When it was first not met [s]; None if that is no matter of one moment.
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
    if not len(values):
        return Breach(f"{name}: there is no value{_window(bound)}")
    if bound.over == "share":
        return _judge_share(name, bound, values)
    if bound.over == "always":
        return _judge_always(name, bound, times, values, series.unit)
    value = {"end": values[-1], "mean": values.mean(), "p95": np.percentile(values, 95)}[bound.over]
    for limit in _limits(bound, np.array([value])):
        if limit.broken[0]:
            told, allowed = _told(value, series.unit), _told(limit.value, series.unit)
            return Breach(f"{name}: {_WORDS[bound.over]}{told} {limit.sign} {allowed}{_window(bound)}")
    return None


def _within(bound: Bound, series: Series) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The values that count, with their times."""
    begin, end = bound.window or (-math.inf, math.inf)
    counts = (series.times >= begin) & (series.times <= end) & ~np.isnan(series.values)
    return series.times[counts], series.values[counts]


def _limits(bound: Bound, values: NDArray[np.float64]) -> list[_Limit]:
    limits = []
    if bound.min is not None:
        limits.append(_Limit("<", bound.min, values < bound.min))
    if bound.max is not None:
        limits.append(_Limit(">", bound.max, values > bound.max))
    return limits


def _judge_always(
    name: str, bound: Bound, times: NDArray[np.float64], values: NDArray[np.float64], unit: str
) -> Breach | None:
    """The worst value is told, and when the bound was first broken; the lower one is looked at first."""
    for limit in _limits(bound, values):
        if limit.broken.any():
            worst = values.min() if limit.sign == "<" else values.max()
            first = float(times[limit.broken.argmax()])
            told = f"{name}: {_told(worst, unit)} {limit.sign} {_told(limit.value, unit)}"
            return Breach(f"{told}, first at {first:g} s", first)
    return None


def _judge_share(name: str, bound: Bound, values: NDArray[np.float64]) -> Breach | None:
    kept = 1.0 - np.logical_or.reduce([limit.broken for limit in _limits(bound, values)]).mean()
    if bound.share is None or kept >= bound.share:
        return None
    limits = " to ".join(f"{limit:g}" for limit in (bound.min, bound.max) if limit is not None)
    side = "within" if None not in (bound.min, bound.max) else "above" if bound.max is None else "below"
    told = f"{name}: {100 * kept:.3g} % of values {side} {limits}"
    return Breach(f"{told}, {100 * bound.share:g} % expected{_window(bound)}")


def _told(value: float, unit: str) -> str:
    return f"{value:.4g}" + (f" {unit}" if unit else "")


def _window(bound: Bound) -> str:
    return "" if bound.window is None else f" between {bound.window[0]:g} and {bound.window[1]:g} s"
