"""How a mission goes: what the rover has stopped at, which gates it has passed, what is left to go."""

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

from harness.world.route import RouteProgress, Standstill, crossed
from harness.world.targets.placing import Target, Where

OF_TARGET = re.compile(r"truth\.target\.(?P<name>[A-Za-z]\w*)\.(?P<what>distance|stop_distance)")


class MissionState(NamedTuple):
    """A mission up to the end of a control period.

    Attributes:
        reached: Targets: those that it has stopped within reach of, and gates passed.
        gates: Of these the gates.
        points: Way points of the route.
        done_s: When the route was finished [s]; NaN before.
        distances: To each target, by name [m].
        stops: Smallest distance of a stop from each target, by name [m]; NaN without a stop.
    """

    reached: int = 0
    gates: int = 0
    points: int = 0
    done_s: float = math.nan
    distances: dict[str, float] = {}  # noqa: RUF012 - of a value that nobody changes
    stops: dict[str, float] = {}  # noqa: RUF012


class MissionAccount:
    """Follows a rover through its mission: the targets of its world, and a route that begins."""

    def __init__(self, targets: Sequence[Target], progress: RouteProgress) -> None:
        self._targets, self._progress = targets, progress
        self._standstill = Standstill()
        self._before: Where | None = None
        self._passed: set[str] = set()
        self._stops = {target.name: math.nan for target in targets}
        self._resets = 0

    def take(self, time_s: float, place: Where, resets: int) -> MissionState:
        """Returns how the mission stands.

        Args:
            time_s: Since the start [s].
            place: Of the rover in the world [m].
            resets: Times that it was put back so far.
        """
        if resets != self._resets:
            self._resets = resets
            self._before = None
            self._standstill.carried_away()
            self._progress.carried_away()
        self._progress.observe(time_s, place)
        for target in self._targets:
            before = self._before or place
            if len(target.posts) == 2 and crossed(before, place, target.posts[0], target.posts[1]):
                self._passed.add(target.name)
        self._before = place
        distances = {target.name: math.dist(place, target.position[:2]) for target in self._targets}
        if self._standstill.observe(time_s, place):
            self._stops = {name: min(d, self._stops[name]) for name, d in distances.items()}  # d for NaN
        stopped_at = {t.name for t in self._targets if self._stops[t.name] <= t.spec.options.reach}
        gates = {target.name for target in self._targets if target.spec.kind == "gate"}
        return MissionState(
            len(stopped_at - gates) + len(self._passed),
            len(self._passed),
            len(self._progress.reached),
            self._progress.done_s,
            distances,
            self._stops,
        )
