"""Wander at changing speeds: what tells how metrics depend on speed."""

from dataclasses import replace
from typing import ClassVar

from harness.drivers.base import DriverContext, Observation
from harness.drivers.wander import Wander
from harness.samples import Twist
from harness.sim_time import NANOSECONDS

SLOWEST, FASTEST = 0.2, 0.9  # of the rover's top speed
SPELL_NS = 8 * NANOSECONDS  # at one speed


class Roam:
    """Goes where `Wander` goes, at a new random speed every few seconds."""

    summary: ClassVar[str] = "wanders at speeds that change every 8 s, up to 0.9 of the top speed"

    def __init__(self, context: DriverContext) -> None:
        self._context = context
        self._wander = Wander(context)
        self._scale = 1.0
        self._until_ns = 0

    def command(self, observation: Observation) -> Twist:
        """Wander's twist, its speed scaled."""
        if observation.time_ns >= self._until_ns:
            rover = self._context.rover
            share = self._context.rng.uniform(SLOWEST, FASTEST)
            self._scale = share * rover.top_speed / rover.cruise_speed
            self._until_ns = observation.time_ns + SPELL_NS
        twist = self._wander.command(observation)
        return replace(twist, linear=self._scale * twist.linear)
