"""A battery and what the motors draw from it: sensor_msgs/BatteryState, and the motors' currents.

The motors' currents and power are those of harness.physics.motor_power. The voltage sinks linearly from
full to empty, and by the battery's own resistance times its current.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import RunFailed, UsageError
from harness.base.sim_time import NANOSECONDS, TICK
from harness.robots import RoverSpec
from harness.sensors.optional import Installation, OptionalSensor, SensorOptions
from harness.spec.value import Length, Share

HOUR = 3600.0  # [s]


@dataclass(frozen=True, slots=True)
class Battery:
    """State of charge; names are those of sensor_msgs/BatteryState."""

    stamp_ns: int
    sensor: str
    voltage: float
    current: float  # negative while it discharges [A]
    charge: float  # what is left [A h]
    percentage: float
    energy: float  # taken since the start [W h]
    motor_currents: tuple[float, float]  # of the left and the right side [A]


class BatteryOptions(SensorOptions):
    """Options of a battery; of what rover.yaml's section `battery` says of it.

    Attributes:
        charge: Share of the capacity at the start.
        capacity: Other than that of rover.yaml [W h]; None for that.
        ends_run: Whether the run fails when it is empty.
    """

    charge: Share = 1.0
    capacity: Length | None = None
    ends_run: bool = False

    def check(self, rover: RoverSpec) -> None:
        """Checks that the motors of a rover are real and that its battery is known."""
        if rover.battery is None or rover.actuators is None or not rover.real:
            raise UsageError(
                f"sensor '{self.name}' needs --actuators real, and the sections 'actuators' and "
                f"'battery' in {rover.folder / 'rover.yaml'}"
            )


class BatterySensor(OptionalSensor[BatteryOptions]):
    """Adds up what the motors of a rover take, whose actuators are real."""

    def _begin(self, installation: Installation[BatteryOptions]) -> None:
        rover, options = self._simulation.scene.rover, installation.options
        options.check(rover)
        assert rover.battery is not None  # noqa: S101 - checked
        self._pack, self._ends_run = rover.battery, options.ends_run
        self._capacity = options.capacity or rover.battery.capacity
        self._taken = self._begun = (1.0 - options.charge) * self._capacity  # [W h]
        # Here, for the table of sensors does without MuJoCo.
        from harness.physics.motor_power import MotorPower  # noqa: PLC0415

        self._motors = MotorPower(self._simulation)
        self._currents, self._power, self._ticks = np.zeros(2), 0.0, 0

    def observe(self, sums: NDArray[np.float64]) -> None:
        """Takes what ticks have taken; RunFailed when the battery is empty and that ends runs."""
        for values in sums:
            self._take(values)

    def _take(self, sums: NDArray[np.float64]) -> None:
        currents, power = self._motors.draw(sums)
        power += self._pack.standby
        self._currents, self._power = self._currents + currents, self._power + power
        self._ticks += 1
        self._taken = min(self._taken + power * TICK / HOUR, self._capacity)
        if self._ends_run and self._taken >= self._capacity:
            now = self._simulation.time_ns / NANOSECONDS
            raise RunFailed(f"{self._simulation.scene.label}'s battery is empty at t = {now:.2f} s")

    def read(self) -> Battery:
        """Returns the state now, and the means of the currents since the last reading."""
        count, pack = max(self._ticks, 1), self._pack
        left = 1.0 - self._taken / self._capacity
        open_voltage = pack.empty + left * (pack.full - pack.empty)
        current = _current(self._power / count, open_voltage, pack.resistance)
        one, other = (self._currents / count).tolist()
        self._currents, self._power, self._ticks = np.zeros(2), 0.0, 0
        voltage, charge = open_voltage - pack.resistance * current, left * self._capacity / pack.nominal
        as_sent = np.array((voltage, -current, charge, left), np.float32).tolist()
        voltage, current, charge, left = as_sent
        now, used = self._simulation.time_ns, self._taken - self._begun
        return Battery(now, self.name, voltage, current, charge, left, used, (one, other))


def _current(power: float, open_voltage: float, resistance: float) -> float:
    """What a pack gives for a power at its terminals [A]: P = (U - R i) i; no more than its most."""
    if resistance == 0.0:
        return power / open_voltage
    within = max(open_voltage**2 - 4.0 * resistance * power, 0.0)
    return (open_voltage - math.sqrt(within)) / (2.0 * resistance)
