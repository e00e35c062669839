"""Estimated poses beside true ones, in the plane: what `evo_ape` and `evo_rpe` compute, and consistency.

Arrays have a row per pose: x, y [m], yaw [rad] in the world. Formulas: Sturm et al., A Benchmark for the
Evaluation of RGB-D SLAM Systems, 2012; Umeyama, 1991; Bar-Shalom et al., Estimation, 2001, section 5.4.
"""

import numpy as np
from numpy.typing import NDArray

Poses = NDArray[np.float64]  # shape (n, 3)
DELTA = 1.0  # [m] of path between two poses of a relative error


def at_times(times: Poses, known: Poses, asked: Poses) -> Poses:
    """Returns poses at other times, interpolated; NaN outside of what is known.

    Args:
        times: Of the known poses [s], ascending, shape (n,).
        known: Shape (n, 3).
        asked: Times [s], shape (m,).
    """
    turns = np.unwrap(known[:, 2])
    columns = (np.interp(asked, times, c, np.nan, np.nan) for c in (known[:, 0], known[:, 1], turns))
    return np.column_stack([*columns])


def aligned(estimate: Poses, truth: Poses) -> Poses:
    """Returns estimates moved and turned to the best fit of positions (Umeyama, without scale)."""
    middle, target = estimate[:, :2].mean(axis=0), truth[:, :2].mean(axis=0)
    a, b = estimate[:, :2] - middle, truth[:, :2] - target
    turn = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum())
    return np.column_stack([turned(a, turn) + target, estimate[:, 2] + turn])


def turned(points: Poses, angle: float | Poses) -> Poses:
    """Returns points, shape (n, 2), turned about the origin by an angle, or one each [rad]."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = points.T
    return np.column_stack([cos * x - sin * y, sin * x + cos * y])


def ate(estimate: Poses, truth: Poses) -> float:
    """Returns the absolute trajectory error, the RMS distance of positions [m]."""
    return rms(np.hypot(*(estimate - truth)[:, :2].T))


def yaw_error(estimate: Poses, truth: Poses) -> float:
    """Returns the RMS error of yaw [rad]."""
    return rms(wrapped(estimate[:, 2] - truth[:, 2]))


def rpe(estimate: Poses, truth: Poses) -> float:
    """Returns the relative pose error, the RMS drift of position over each metre of the true path [m].

    NaN where the path is shorter.
    """
    path = np.r_[0.0, np.hypot(*np.diff(truth[:, :2], axis=0).T)]
    ends, since = [0], 0.0
    for index, step in enumerate(path.tolist()):
        since += step
        if since >= DELTA:
            ends.append(index)
            since = 0.0
    first, last = np.array(ends[:-1], dtype=int), np.array(ends[1:], dtype=int)
    if not len(first):
        return float("nan")
    moves = [turned((of[last] - of[first])[:, :2], -of[first, 2]) for of in (estimate, truth)]
    return rms(np.hypot(*(moves[0] - moves[1]).T))


def nees(estimate: Poses, truth: Poses, covariances: Poses) -> float:
    """Returns the mean normalised estimation error squared: 3 of a consistent filter, bold ones more.

    Args:
        estimate: Shape (n, 3).
        truth: Shape (n, 3).
        covariances: Of x, y and yaw, shape (n, 3, 3); NaN where one has no inverse.
    """
    error = estimate - truth
    error[:, 2] = wrapped(error[:, 2])
    try:
        return float((error * np.linalg.solve(covariances, error[..., None])[..., 0]).sum(axis=1).mean())
    except np.linalg.LinAlgError:
        return float("nan")


def wrapped(angle: Poses) -> Poses:
    """Returns angles as those from -pi to pi."""
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)


def rms(errors: Poses) -> float:
    """Returns the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(errors))))
