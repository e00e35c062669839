"""Watches a simulation for what only it knows: path, contacts, slip, tilt.

Observed once per clock tick, with the contacts of every step, so that no contact between two samples
is missed.
"""

import math
from collections.abc import Sequence
from functools import cached_property

from harness.base.sim_time import TICK
from harness.physics.simulation import Simulation
from harness.physics.truth.contact_events import ContactEvents
from harness.physics.truth.wheels import SoilWheels, Wheels
from harness.samples import ContactKind, Truth, TruthState
from harness.world.statistics import RoughnessMap
from rover_metrics.core import rotation

TIPPED_OVER = math.radians(75.0)  # between the static tip angles (44-59 deg) and lying on a side


class TruthRecorder:
    """Watches a simulation; call `observe` after every tick.

    Attributes:
        events: The contact events.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._wheels = Wheels(simulation)
        self.events = ContactEvents(simulation.contacts.name_of)
        self._previous = simulation.position
        self._path = 0.0
        self._lowest_upright = 1.0
        self._contact_ticks: dict[ContactKind, int] = {"hazard": 0, "rock": 0, "scrape": 0}
        self._touched: set[ContactKind] = set()  # since the last state
        self._force = 0.0
        wheels = len(simulation.scene.rover.wheel_joints)
        self._slip_sums, self._slip_counts = [0.0] * wheels, [0] * wheels
        self._resets = 0
        self._soil = None if simulation.physics.bed is None else SoilWheels(simulation)

    @cached_property
    def _roughness(self) -> RoughnessMap:
        return RoughnessMap(self._simulation.scene.world.ground)

    def observe(self, pose: Sequence[float] | None = None) -> None:
        """Takes the tick that has just been simulated into account.

        The pose at its end is position [m] and w, x, y, z; None for what it is now.
        """
        x, y, z, qw, qx, qy, qz = self._simulation.pose.tolist() if pose is None else pose
        self._path += math.dist((x, y, z), self._previous)
        self._previous = x, y, z
        self._lowest_upright = min(self._lowest_upright, rotation.upright((qx, qy, qz, qw)))
        strongest = self._simulation.contacts.strongest
        self.events.observe(self._simulation.time_ns, strongest)
        for kind, touch in strongest.items():
            self._contact_ticks[kind] += 1
            self._touched.add(kind)
            if kind == "hazard":
                self._force = max(self._force, touch.force)

    def carried_away(self) -> None:
        """Takes note of a reset: the way back is no path, and what was touched is left."""
        self._previous = self._simulation.position
        self.events.close()
        self._resets += 1
        if self._soil is not None:
            self._soil.begin_anew()

    def state(self) -> TruthState:
        """Returns the truth now and since the last call."""
        wheels = self._wheels.motion()
        for index, wheel in enumerate(wheels):
            if wheel.moves:
                self._slip_sums[index] += abs(wheel.slip)
                self._slip_counts[index] += 1
        squares = [self._roughness.mean_square(wheel.x, wheel.y) for wheel in wheels]
        touched = self._touched
        state = TruthState(
            stamp_ns=self._simulation.time_ns,
            hazard_contact="hazard" in touched,
            rock_contact="rock" in touched,
            scrape="scrape" in touched,
            contact_force=self._force,
            speed=self._simulation.velocity[0],
            path_length=self._path,
            slip=tuple(wheel.slip for wheel in wheels),
            roughness=math.sqrt(sum(squares) / len(squares)),
            soil=None if self._soil is None else self._soil.state(),
        )
        self._touched.clear()
        self._force = 0.0
        return state

    def truth(self) -> Truth:
        """Returns the totals up to now."""
        tilt = math.acos(max(-1.0, min(1.0, self._lowest_upright)))
        begun = self.events.begun
        seconds = {kind: ticks * TICK for kind, ticks in self._contact_ticks.items()}
        slips = zip(self._slip_sums, self._slip_counts, strict=True)
        return Truth(
            time_ns=self._simulation.time_ns,
            path_length=self._path,
            position=self._previous,
            hazard_contacts=begun["hazard"],
            rock_contacts=begun["rock"],
            scrapes=begun["scrape"],
            hazard_contact_s=seconds["hazard"],
            rock_contact_s=seconds["rock"],
            scrape_s=seconds["scrape"],
            mean_slip=sum(self._slip_sums) / (sum(self._slip_counts) or 1),
            wheel_slip=tuple(total / (n or 1) for total, n in slips),
            largest_tilt=tilt,
            tipped_over=tilt > TIPPED_OVER,
            resets=self._resets,
        )
