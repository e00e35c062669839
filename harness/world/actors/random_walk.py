"""A seeded random walk: straight from one free point to another, for ever; it gives way to nobody."""

import math
from collections.abc import Iterator

import numpy as np

from harness.base.errors import UsageError
from harness.samples import Place
from harness.spec.actor import ActorOptions
from harness.world.actors.free_space import FreeSpace, along
from harness.world.actors.route import Route

TRIES = 200
SHORTEST = 1.0  # [m] of a leg
KEPT_CLEAR = 2.0  # [m] around the rover's start, when they begin

Point = tuple[float, float]


class RandomWalk:
    """The way points of one walker, made as they are needed; the same for the same generator.

    Without a free point to begin at there is a UsageError.

    Args:
        name: Whose they are, for the message.
        space: Where one can walk.
        centre: Around which [m].
        options: How far from there, and the radius of the body.
        rng: Source of randomness.
    """

    def __init__(
        self, name: str, space: FreeSpace, centre: Point, options: ActorOptions, rng: np.random.Generator
    ) -> None:
        self._space, self._centre, self._within = space, centre, options.within
        self._radius, self._rng = options.radius, rng
        begin = next((point for point in self._draws() if math.dist(point, centre) > KEPT_CLEAR), None)
        if begin is None:
            raise UsageError(
                f"actor '{name}': no free place within {self._within:g} m of the rover's start at "
                f"{centre[0]:g},{centre[1]:g}; give a larger within=M"
            )
        self._points = [begin]

    def point(self, index: int) -> Point:
        """Returns the way point of that number."""
        while len(self._points) <= index:
            self._points.append(self._next(self._points[-1]))
        return self._points[index]

    def _next(self, here: Point) -> Point:
        for point in self._draws():
            if math.dist(point, here) < SHORTEST:
                continue
            if self._space.blocked(along((here, point)), self._radius) is None:
                return point
        return self._points[-2] if len(self._points) > 1 else here  # the way that one came by is free

    def _draws(self) -> Iterator[Point]:
        """Free points of a disc, uniformly."""
        draws = self._rng.uniform(size=(TRIES, 2))
        away, turn = self._within * np.sqrt(draws[:, 0]), math.tau * draws[:, 1]
        x, y = self._centre[0] + away * np.cos(turn), self._centre[1] + away * np.sin(turn)
        points = np.round(np.column_stack([x, y]), 3)  # the last bits of cos differ between processors
        return (
            (point[0], point[1])
            for point in points.tolist()
            if self._space.blocked(np.array([point]), self._radius) is None
        )


class RandomWalker:
    """Follows a random walk at one speed: a route whose legs are made as they are walked.

    Args:
        way_points: Where to.
        speed: [m/s].
        delay: Before the walk begins [s].
    """

    def __init__(self, way_points: RandomWalk, speed: float, delay: float) -> None:
        self._way_points, self._speed, self._delay = way_points, speed, delay
        self._times: list[float] = [0.0]
        self._route = Route((0.0,), (way_points.point(0),), loops=False, delay=delay)

    def place(self, time_s: float) -> Place:
        """Returns where one is and looks at a time [s]."""
        if time_s - self._delay > self._times[-1] - 1.0:
            self._extend(time_s - self._delay + 60.0)
        return self._route.place(time_s)

    def _extend(self, until: float) -> None:
        point = self._way_points.point
        while self._times[-1] <= until:
            index = len(self._times)
            leg = math.dist(point(index - 1), point(index))
            self._times.append(self._times[-1] + (leg / self._speed or 1.0))  # 1 s where all is blocked
        points = tuple(map(point, range(len(self._times))))
        self._route = Route(tuple(self._times), points, loops=False, delay=self._delay)
