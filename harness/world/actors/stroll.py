"""A seeded random walk: straight from one free point to another, for ever."""

import math
from collections.abc import Iterator

import numpy as np

from harness.base.errors import UsageError
from harness.samples import Place
from harness.world.actors.room import Room
from harness.world.actors.route import Route

TRIES = 200
SHORTEST = 1.0  # [m] of a leg
KEPT_CLEAR = 2.0  # [m] around the rover's start, when they begin

Spot = tuple[float, float]


class Stroll:
    """The way points of one walker, made as they are needed; the same for the same generator.

    Args:
        name: Whose they are, for the message.
        room: Where one can walk.
        centre: Around which [m].
        within: How far from it [m].
        radius: Of the body [m].
        rng: Source of randomness.

    Raises:
        UsageError: There is no free point to begin at.
    """

    def __init__(
        self,
        name: str,
        room: Room,
        centre: Spot,
        *,
        within: float,
        radius: float,
        rng: np.random.Generator,
    ) -> None:
        self._room, self._centre, self._within = room, centre, within
        self._radius, self._rng = radius, rng
        begin = next((spot for spot in self._draws() if math.dist(spot, centre) > KEPT_CLEAR), None)
        if begin is None:
            raise UsageError(
                f"actor '{name}': no free place within {within:g} m of the rover's start at "
                f"{centre[0]:g},{centre[1]:g}; give a larger within=M"
            )
        self._spots = [begin]

    def spot(self, index: int) -> Spot:
        """Returns the way point of that number."""
        while len(self._spots) <= index:
            self._spots.append(self._next(self._spots[-1]))
        return self._spots[index]

    def _next(self, here: Spot) -> Spot:
        for spot in self._draws():
            if math.dist(spot, here) >= SHORTEST and self._room.is_clear(here, spot, self._radius):
                return spot
        return self._spots[-2] if len(self._spots) > 1 else here  # the way that one came by is free

    def _draws(self) -> Iterator[Spot]:
        """Free points of a disc, uniformly."""
        draws = self._rng.uniform(size=(TRIES, 2))
        away, turn = self._within * np.sqrt(draws[:, 0]), math.tau * draws[:, 1]
        x, y = self._centre[0] + away * np.cos(turn), self._centre[1] + away * np.sin(turn)
        spots = np.round(np.column_stack([x, y]), 3)  # the last bits of cos differ between processors
        return (
            (spot[0], spot[1])
            for spot in spots.tolist()
            if self._room.trouble(np.array([spot]), self._radius) is None
        )


class StrollRoute:
    """A stroll at one speed, whoever is in the way: a route whose legs are made as they are walked."""

    def __init__(self, stroll: Stroll, speed: float, delay: float) -> None:
        self._stroll, self._speed, self._delay = stroll, speed, delay
        self._times: list[float] = [0.0]
        self._route = Route((0.0,), (stroll.spot(0),), loops=False, delay=delay)

    def place(self, time_s: float) -> Place:
        """Returns where one is and looks at a time [s]."""
        if time_s - self._delay > self._times[-1] - 1.0:
            self._extend(time_s - self._delay + 60.0)
        return self._route.place(time_s)

    def _extend(self, until: float) -> None:
        while self._times[-1] <= until:
            number = len(self._times)
            leg = math.dist(self._stroll.spot(number - 1), self._stroll.spot(number))
            self._times.append(self._times[-1] + (leg / self._speed or 1.0))  # 1 s where there is no way
        spots = tuple(self._stroll.spot(number) for number in range(len(self._times)))
        self._route = Route(tuple(self._times), spots, loops=False, delay=self._delay)
