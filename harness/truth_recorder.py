"""Watches a simulation and sums up what only it knows: path, contacts, slip, tilt.

Observed once per clock tick from the contact counts of every step, so that no contact between two
sensor samples is missed.
"""

import math

import numpy as np

from harness.sim_time import NANOSECONDS, TICK_NS
from harness.simulation import Simulation
from harness.truth import EVENT_GAP_NS, SLIP_SPEED, TIPPED_OVER, Truth, slip_ratio
from harness.world.scene import HAZARD_CONTACT, ROCK_CONTACT, SCRAPE_CONTACT


class TruthRecorder:
    """Watches a simulation; call `observe` after every tick."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        rover, model = simulation.scene.rover, simulation.model
        self._wheel_dofs = np.array([int(model.joint(n).dofadr[0]) for n in rover.wheel_joints])
        self._radius, self._half_track = rover.wheel_radius, rover.track / 2
        self._hazard = simulation.summed(HAZARD_CONTACT)
        self._rock = simulation.summed(ROCK_CONTACT)
        names = [model.sensor(i).name for i in range(model.nsensor)]
        self._scrapes = [simulation.summed(n) for n in names if n.startswith(SCRAPE_CONTACT)]
        self._previous = simulation.position
        self._path = 0.0
        self._hazard_events = 0
        self._last_hazard_ns = -EVENT_GAP_NS
        self._hazard_ticks = self._rock_ticks = self._scrape_ticks = 0
        self._slip_sum, self._slip_samples = 0.0, 0
        self._lowest_upright = 1.0

    def observe(self) -> None:
        """Takes the tick that has just been simulated into account."""
        position = self._simulation.position
        self._path += math.dist(position, self._previous)
        self._previous = position
        self._observe_contacts()
        self._observe_attitude_and_slip()

    def _observe_contacts(self) -> None:
        self._rock_ticks += bool(self._rock[0])
        self._scrape_ticks += any(scrape[0] for scrape in self._scrapes)
        if self._hazard[0]:
            now_ns = self._simulation.time_ns
            self._hazard_events += now_ns - self._last_hazard_ns > EVENT_GAP_NS
            self._last_hazard_ns = now_ns
            self._hazard_ticks += 1

    def _observe_attitude_and_slip(self) -> None:
        data = self._simulation.data
        w, x, y, z = data.qpos[3:7].tolist()
        self._lowest_upright = min(self._lowest_upright, 1.0 - 2.0 * (x * x + y * y))
        forward = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y))
        vx, vy, vz, _, _, yaw_rate = data.qvel[:6].tolist()
        speed = vx * forward[0] + vy * forward[1] + vz * forward[2]
        left, right = speed - yaw_rate * self._half_track, speed + yaw_rate * self._half_track
        rates = data.qvel[self._wheel_dofs].tolist()
        for rate, ground_speed in zip(rates, (left, left, right, right), strict=True):
            wheel_speed = rate * self._radius
            if max(abs(wheel_speed), abs(ground_speed)) >= SLIP_SPEED:
                self._slip_sum += abs(slip_ratio(wheel_speed, ground_speed))
                self._slip_samples += 1

    def truth(self) -> Truth:
        """The totals up to now."""
        tick_s = TICK_NS / NANOSECONDS
        tilt = math.acos(max(-1.0, min(1.0, self._lowest_upright)))
        return Truth(
            time_ns=self._simulation.time_ns,
            path_length=self._path,
            position=self._previous,
            hazard_contacts=self._hazard_events,
            hazard_contact_s=self._hazard_ticks * tick_s,
            rock_contact_s=self._rock_ticks * tick_s,
            scrape_s=self._scrape_ticks * tick_s,
            mean_slip=self._slip_sum / self._slip_samples if self._slip_samples else 0.0,
            largest_tilt=tilt,
            tipped_over=tilt > TIPPED_OVER,
        )
