"""Whether the columns of a log agree with each other, as they do if the node counts as it should."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from rover_metrics.analysis.logs.parsing import Tally
from rover_metrics.analysis.metric import (
    ACCELERATION,
    CLEARANCE,
    COLLISION,
    ROUGH,
    SMOOTHNESS,
    SMOOTHNESS_SUM,
)
from rover_metrics.core.metrics import WINDOW
from rover_metrics.core.thresholds import THRESHOLD_INFO, Thresholds

_ROUNDING = 1e-4  # of a log's four decimals, twice over
_FEWEST_TELLING = 10  # rows: that as many quotients are whole by chance is ruled out
_LARGEST_ERROR = 0.1  # of a quotient, beyond which being whole says nothing


@dataclass(frozen=True)
class _Flag:
    """A flag, the column it is drawn from, and the threshold beyond which it is 1."""

    column: str
    level: str
    threshold: str
    sign: int  # 1 if it is 1 above the threshold, -1 if below


_FLAGS = (
    _Flag(COLLISION, CLEARANCE, "collision_threshold", -1),
    _Flag(ROUGH, ACCELERATION, "rough_terrain_threshold", 1),
)
CHECKED_COLUMNS = (*(name for flag in _FLAGS for name in (flag.column, flag.level)), SMOOTHNESS)


def describe_consistency(rows: pd.DataFrame, thresholds: Thresholds) -> list[str]:
    """Returns what contradicts itself in the rows of a log that was made with these thresholds.

    Rows are by line, with what the log has of CHECKED_COLUMNS and of the sum of smoothness.
    """
    flags = [flag for flag in _FLAGS if {flag.column, flag.level} <= set(rows)]
    findings = [_contradiction(rows, flag, getattr(thresholds, flag.threshold)) for flag in flags]
    if {SMOOTHNESS, SMOOTHNESS_SUM} <= set(rows) and _is_mean_since_start(rows):
        findings.append(
            f"{SMOOTHNESS} is the mean since the start, as RoboTerrain's node writes it since 2025 "
            f"(its buffer is never trimmed), not of the last {WINDOW} samples"
        )
    return [finding for finding in findings if finding]


def _contradiction(rows: pd.DataFrame, flag: _Flag, threshold: float) -> str:
    """Describes the rows whose flag is not what their level says; at the threshold it may be either."""
    known = rows[rows[flag.column].notna() & rows[flag.level].notna()]
    is_on, level = known[flag.column] == 1, known[flag.level].astype(np.float64)
    beyond = flag.sign * (level - threshold)
    wrong = known.index[(np.abs(beyond) > _ROUNDING) & (is_on != (beyond > 0))]
    if not wrong.size:
        return ""
    tally = Tally()
    tally.add(wrong, f"{known[flag.column][wrong[0]]:g} at {level[wrong[0]]:g}")
    unit = THRESHOLD_INFO[flag.threshold].unit
    what = f" whose {flag.column} contradicts {flag.level} and {flag.threshold} {threshold:g} {unit}"
    fit = _fitting(flag.sign * level[is_on], flag.sign * level[~is_on], flag.sign)
    return tally.describe("row", what, f"another rule or threshold was at work{fit}")


def _fitting(on: "pd.Series[float]", off: "pd.Series[float]", sign: int) -> str:
    """Returns which thresholds would explain all flags; levels are multiplied by the flag's sign."""
    if not off.empty and not on.empty and off.max() >= on.min():
        return ""
    ends = sorted(sign * end for end in (off.max(), on.min()) if np.isfinite(end))
    if len(ends) == 2:
        return f", such as one between {ends[0]:g} and {ends[1]:g}"
    side = "below" if off.empty == (sign == 1) else "above"
    return f", such as one {side} {ends[0]:g}"


def _is_mean_since_start(rows: pd.DataFrame) -> bool:
    """Whether the sum over the mean is a whole number in each row: that of all samples so far.

    Of a rover at rest a window has the same mean; so the shaking must have varied.
    """
    mean, total = (rows[name].to_numpy(np.float64) for name in (SMOOTHNESS, SMOOTHNESS_SUM))
    with np.errstate(divide="ignore", invalid="ignore"):
        samples = total / mean
        error = samples * _ROUNDING / mean
    telling = (samples > 1.5 * WINDOW) & (error < _LARGEST_ERROR)
    samples, total, error = samples[telling], total[telling], error[telling]
    if samples.size < _FEWEST_TELLING or np.any(np.abs(samples - np.round(samples)) > error):
        return False
    grows = np.diff(samples) > 0.5
    steps = np.diff(total)[grows] / np.diff(samples)[grows]
    return bool(steps.size and np.ptp(steps) > 0.01 * steps.mean())
