"""Randomness that a test decides, and a rover that does exactly what is commanded."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import chain, repeat

import pytest

from harness.drivers.base import Driver, Observation
from harness.samples import Twist


class Dice:
    """Stands in for a numpy generator: each draw lies at the next of the given shares of its range.

    A normal deviate lies so many deviations off the mean, an integer at that share of those there are.
    """

    def __init__(self, shares: Iterable[float]) -> None:
        self._shares = iter(shares)
        self.draws = 0

    def random(self) -> float:
        self.draws += 1
        return next(self._shares)

    def uniform(self, low: float, high: float) -> float:
        return low + self.random() * (high - low)

    def normal(self, mean: float, deviation: float) -> float:
        return mean + self.random() * deviation

    def integers(self, count: int) -> int:
        return min(int(self.random() * count), count - 1)


@dataclass
class IdealRover:
    """A rover without inertia or slip, asked for a command every 50 ms."""

    driver: Driver
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    touches: Callable[["IdealRover"], bool] = lambda _: False
    period: int = 0
    linear: float = 0.0
    path: list[tuple[float, float, float]] = field(default_factory=list)

    def steps(self, count: int) -> Iterator[Twist]:
        for _ in range(count):
            self.path.append((self.x, self.y, self.yaw))
            time_ns = self.period * 50_000_000
            yaw = math.remainder(self.yaw, math.tau)
            touches = self.touches(self)
            twist = self.driver.command(Observation(time_ns, self.x, self.y, yaw, None, touches))
            self.linear = twist.linear
            self.yaw += twist.angular * 0.05
            self.x += twist.linear * 0.05 * math.cos(self.yaw)
            self.y += twist.linear * 0.05 * math.sin(self.yaw)
            self.period += 1
            yield twist


@pytest.fixture
def dice() -> Callable[..., Dice]:
    """Dice that show these shares and then, for ever, the last one."""
    return lambda *shares: Dice(chain(shares, repeat(shares[-1])))


@pytest.fixture
def ideal() -> type[IdealRover]:
    """An ideal rover: `steps` yields its driver's twists, `path` is where it was when it got them."""
    return IdealRover
