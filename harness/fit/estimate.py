"""What a fit says of one number: its value with an interval, or why the recording does not show it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from math import hypot, isfinite, nan
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from harness.robots import RoverSpec
from harness.validate.recordings.recording import Series

CERTAIN = 2.2  # standard deviations on either side: 95 % of Student's t with BLOCKS - 1
MOST = 6  # tries of a round
ROUNDS = 2  # of at most MOST tries, each with new derivatives
BLOCKS = 12  # parts of a recording that count as independent of each other
LEAST_FREE = 1e-3  # of a block's errors: what all but hangs on it is scaled up by no more
VAGUE = 0.3  # half an interval over the value, from which on it is not known
# Tolerances by which our drives are off, since contacts are rough: with it the truth was in 106 of 112
# intervals of 95 % (docs/real_rovers.md).
ROUGH = 0.3
FACTS = {"friction": "wheel_friction", "radius": "wheel_radius"}  # of the model, where tyres say nothing


@dataclass(frozen=True)
class Estimate:
    """One number of a rover.

    Attributes:
        name, unit: As a table shows it.
        key: Its place in rover.yaml, as "tyres.friction"; "" of what follows from others.
        before: The folder's value; NaN without one.
        after: The recording's; NaN if it is not known.
        half: Half of its interval of 95 %.
        why: Why it is not known; "" if it is.
        scale: For values that may be 0: half an interval up to which they count as known.
        rough: What `half` comes to at least, because our own drives are off by ROUGH.
    """

    name: str
    unit: str
    key: str
    before: float
    after: float = nan
    half: float = nan
    why: str = ""
    scale: float = 0.0
    rough: float = 0.0

    @property
    def is_known(self) -> bool:
        """Whether the recording shows it."""
        return not self.why

    def judged(self, after: float, half: float, lack: str) -> "Estimate":
        """Returns the estimate with a value, or with why it is not known where its interval is too wide.

        Args:
            after: The recording's value, in the estimate's unit; not finite if there is none.
            half: Half of its interval of 95 %.
            lack: What the recording lacks if that is too wide.
        """
        estimate = replace(self, after=after, half=half)
        if isfinite(after) and half <= max(VAGUE * abs(after), self.scale):
            return estimate
        reason = f"{after:.3g} +- {half:.2g} is too vague" if isfinite(half) else "nothing tells it"
        return replace(estimate, after=nan, why=f"{reason}: {lack}")

    def widened(self, among: "Estimate") -> "Estimate":
        """Returns the estimate with an interval that holds what was found among more unknowns, too."""
        wide = hypot(max(among.half, among.rough), self.after - among.after)
        return replace(self, half=max(self.half, self.rough, wide))

    def unknown(self, why: str) -> "Estimate":
        """Returns the estimate as one that the recording does not show."""
        return replace(self, why=why)


def of(rover: RoverSpec, key: str) -> float:
    """Returns what a rover has at a place of rover.yaml, its model's value where that says nothing."""
    section, _, name = key.rpartition(".")
    value = getattr(getattr(rover, section) if section else rover, name)
    value = getattr(rover, FACTS[name]) if value is None and name in FACTS else value
    return nan if value is None else float(value)


def with_values(rover: RoverSpec, values: Iterable[tuple[str, float]]) -> RoverSpec:
    """Returns a rover with other values at places of rover.yaml."""
    for key, value in values:
        section, _, name = key.rpartition(".")
        more: dict[str, object] = {FACTS[name]: value} if name in FACTS else {}
        if name == "radius":
            more["rest_height"] = rover.rest_height + value - rover.wheel_radius
        whole = getattr(rover, section).but(**{name: value}) if section else value
        rover = rover.but(**{section or name: whole}, **more)
    return rover


def fitted(rover: RoverSpec, estimates: Iterable[Estimate]) -> RoverSpec:
    """Returns a rover with all that is known, apart from its IMU's mount."""
    known = (one for one in estimates if one.is_known and one.key and not one.key.startswith("imu."))
    return with_values(rover, [(one.key, one.after) for one in known])


class Minimum(NamedTuple):
    """The parameters of least residuals, and how well they are known.

    Attributes:
        point: The parameters.
        halves: Halves of their intervals of 95 %, by the residuals that are left.
        rough: Halves of their intervals of 95 % if each residual is off by ROUGH.
        cost: Half the sum of what least_squares makes of the residuals.
    """

    point: Series
    halves: Series
    rough: Series
    cost: float


def minimise(
    residuals: Callable[[Series], Series], start: Series, bounds: tuple[Series, Series], steps: Series
) -> Minimum:
    """Returns the parameters of least residuals.

    Residuals are over their tolerances and in the order of time; large ones count linearly. Those of
    a block depend on each other, so the interval is that of a sandwich over BLOCKS.

    Args:
        residuals: Of parameters.
        start: Where to begin; clipped into the bounds.
        bounds: Lowest and highest.
        steps: For derivatives, so large that what is rough below them does not count.
    """
    low, high = bounds

    @lru_cache(maxsize=4)
    def known(point: bytes) -> Series:
        return residuals(np.frombuffer(point))

    def values(point: Series) -> Series:
        return known(point.tobytes())

    def differences(point: Series) -> Series:
        inward = np.where(point + steps > high, -steps, steps)
        columns = np.array([residuals(other) for other in point + np.diag(inward)])
        slopes: Series = ((columns - values(point)) / inward[:, None]).T
        return slopes

    point = np.clip(start, low + 1e-6 * (high - low), high - 1e-6 * (high - low))
    for _ in range(ROUNDS):
        solution = least_squares(
            values, point, jac=_broyden(values, differences, steps), bounds=bounds, loss="soft_l1",
            x_scale=steps, max_nfev=MOST, xtol=1e-3, ftol=1e-3,
        )  # fmt: skip
        point = solution.x
    weights = (1.0 + solution.fun**2) ** -0.25  # roots of those of soft L1
    jacobian = weights[:, None] * differences(point)
    halves = CERTAIN * deviations(jacobian, weights * solution.fun)
    rough = CERTAIN * ROUGH * np.sqrt(np.diag(np.linalg.pinv(jacobian.T @ jacobian)))
    return Minimum(point, halves, rough, float(solution.cost))


def _broyden(
    values: Callable[[Series], Series], differences: Callable[[Series], Series], steps: Series
) -> Callable[[Series], Series]:
    """Returns derivatives by differences at first, then by Broyden's update: values may take long."""
    last: list[tuple[Series, Series, Series]] = []

    def slopes(point: Series) -> Series:
        now = values(point)
        if last:
            before, then, jacobian = last.pop()
            way = (point - before) / steps**2
            jacobian = jacobian + np.outer(
                now - then - jacobian @ (point - before), way / (way @ (point - before))
            )
        else:
            jacobian = differences(point)
        last.append((point, now, jacobian))
        return jacobian

    return slopes


def deviations(jacobian: Series, left: Series) -> Series:
    """Returns the parameters' standard deviations, with blocks of residuals that depend on each other.

    The estimate has made a block's residuals smaller than its errors, the more the fewer other blocks
    tell of a parameter: their sums are scaled up by as much (CR2 of Bell and McCaffrey 2002).

    Args:
        jacobian: Of the residuals, shape (n, parameters).
        left: The residuals, in the order of time, shape (n,).
    """
    values, axes = np.linalg.eigh(jacobian.T @ jacobian)
    known = values > 1e-15 * values.max(initial=0.0)
    roots = axes[:, known] / np.sqrt(values[known])
    spread = np.zeros((roots.shape[1],) * 2)
    for block in np.array_split(np.arange(left.size), min(BLOCKS, left.size)):
        own, turn = np.linalg.eigh((rows := jacobian[block] @ roots).T @ rows)
        score = turn @ (turn.T @ (rows.T @ left[block]) / np.sqrt((1.0 - own).clip(LEAST_FREE)))
        spread += np.outer(score, score)
    result: Series = np.sqrt(np.diag(roots @ spread @ roots.T))
    silent = np.abs(jacobian).sum(axis=0) == 0.0
    result[silent] = np.inf
    return result


def slope(x: Series, y: Series) -> tuple[float, float]:
    """Returns y over x by least squares, and half of its interval; NaN and infinite without data."""
    square = float(x @ x)
    if not square > 0.0:
        return nan, np.inf
    value = float(x @ y) / square
    return value, float(CERTAIN * deviations(x[:, None], y - value * x)[0])
