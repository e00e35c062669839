"""Error models of sensors: what lies between the exact value and the reading.

Every model draws only what it needs from the generator it is given, so that a term that is switched
off changes nothing.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import NANOSECONDS
from harness.samples import Vector3
from harness.spec.value import NotNegative, Share, Value


@dataclass(frozen=True, kw_only=True)
class AxisErrors:
    """Errors of each of three equal axes, in the sensor's unit."""

    white: float = 0.0  # standard deviation of a reading
    bias: float = 0.0  # standard deviation of the bias at switch-on
    walk: float = 0.0  # standard deviation that the bias gains in the first second [unit/sqrt(s)]
    # after which 1/e of the bias is left and the rest drawn anew [s], so that its deviation stays
    # (a Gauss-Markov process of first order); infinite for a bias that stays
    correlation_time: float = math.inf
    step: float = 0.0  # quantisation; 0 for none
    limit: float = math.inf  # largest magnitude that can be read

    @property
    def variance(self) -> float:
        """Returns that of a reading, over all sensors of this kind, at switch-on."""
        return self.white**2 + self.bias**2


class AxisTriad:
    """Three axes with errors; remembers how far their biases have wandered."""

    def __init__(self, errors: AxisErrors, rng: np.random.Generator) -> None:
        self._errors, self._rng = errors, rng
        self._bias = _gaussian(rng, errors.bias, (3,))
        self._stamp_ns: int | None = None

    def corrupt(self, value: Vector3, stamp_ns: int) -> Vector3:
        """Returns the reading for an exact value; stamps must not go backwards."""
        errors = self._errors
        self._wander(stamp_ns)
        read = np.array(value) + self._bias + _gaussian(self._rng, errors.white, (3,))
        if errors.step:
            read = errors.step * np.round(read / errors.step)
        x, y, z = np.clip(read, -errors.limit, errors.limit).tolist()
        return x, y, z

    def _wander(self, stamp_ns: int) -> None:
        elapsed = 0.0 if self._stamp_ns is None else (stamp_ns - self._stamp_ns) / NANOSECONDS
        self._stamp_ns, errors = stamp_ns, self._errors
        kept = math.exp(-elapsed / errors.correlation_time)
        renewed = errors.bias * math.sqrt(1.0 - kept**2)
        gained = math.hypot(errors.walk * math.sqrt(elapsed), renewed)
        self._bias = kept * self._bias + _gaussian(self._rng, gained, (3,))


class RangeErrors(Value):
    """Errors of a lidar's ranges.

    Attributes:
        white: Standard deviation of a range [m].
        step: Quantisation [m]; 0 for none.
        dropout: Share of the returns that are lost.
    """

    white: NotNegative = 0.0
    step: NotNegative = 0.0
    dropout: Share = 0.0

    def corrupt(
        self,
        ranges: NDArray[np.float32],
        limits: tuple[float, float],
        rng: np.random.Generator,
        *,
        lost: float = math.inf,
    ) -> NDArray[np.float32]:
        """Returns ranges [m] as read, REP-117 coded.

        Args:
            ranges: Exact ones [m], shape (beams,); +inf where nothing is.
            limits: Nearest and farthest range that can be read [m].
            rng: Draws the errors.
            lost: What a lost return reads: of a lidar it is like a miss, which is +inf.
        """
        read = (ranges + _gaussian(rng, self.white, ranges.shape)).astype(np.float32)  # inf stays inf
        if self.step:
            read = (self.step * np.round(read / self.step)).astype(np.float32)
        nearest, farthest = limits
        read[read < nearest] = -np.inf
        read[read > farthest] = np.inf
        if self.dropout:
            read[np.isfinite(read) & (rng.random(read.shape) < self.dropout)] = lost
        return read


@dataclass(frozen=True, kw_only=True)
class ContactChatter:
    """Wheels whose contacts break and close from one physics step to the next, as meshes in Gazebo do.

    A reading that falls into a disturbed step finds the rover carried by more or less than its weight,
    between free fall and several g, the mean being its weight. A tyre that slides pushes it sideways
    as well, by no more than the load times a coefficient along each axis: the engine's friction pyramid.
    How many readings are disturbed or slide grows with the wheels' speed v, as 1 - exp(-v / v0).
    Some of the disturbed ones find no wheel on the ground, and the falling rover is caught: in few
    steps, with many times the weight, so that momentum balances.
    """

    speed: float  # v0 of the disturbed ones [m/s]
    shape: float  # of the gamma distribution of the load, whose mean is 1; less is wilder
    falling: float  # share of the disturbed ones in free fall, whose load is 0
    landing: float  # mean load of those in which the rover is caught, exponentially distributed; above 1
    sliding_speed: float  # v0 of those that slide [m/s]
    friction: float  # bound of the friction along each horizontal axis over the load; evenly distributed

    def shake(self, force: Vector3, wheel_speed: float, rng: np.random.Generator) -> Vector3:
        """Returns the specific force of one step [m/s^2].

        Args:
            force: Mean over the window, in the IMU's frame as what is returned [m/s^2].
            wheel_speed: Speed by the wheels [m/s].
            rng: Draws what happens.
        """
        loads = rng.gamma(self.shape, 1.0 / self.shape), self.landing * rng.exponential(), 0.0
        fate = rng.random() - self.falling
        load = loads[2 if fate < 0.0 else 1 if fate < self.falling / (self.landing - 1.0) else 0]
        along, across = self.friction * math.hypot(*force) * rng.uniform(-1.0, 1.0, 2)
        disturbed, slides = (
            rng.random() < -math.expm1(-abs(wheel_speed) / v0) for v0 in (self.speed, self.sliding_speed)
        )
        load = load if disturbed else 1.0
        x, y, z = force
        x, y = (x + along, y + across) if slides else (x, y)
        return load * x, load * y, load * z


def _gaussian(rng: np.random.Generator, deviation: float, shape: tuple[int, ...]) -> NDArray[np.float64]:
    return rng.normal(0.0, deviation, shape) if deviation else np.zeros(shape)
