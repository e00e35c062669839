"""Faults between commands and wheels: commands late or lost, weak motors, wheels that are stuck.

Unlike those of sensors they change the drive itself. Each draws from its own generator.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.base.sim_time import NANOSECONDS
from harness.base.streams import FAULTS, generator
from harness.faults.base import Fault
from harness.samples import Twist

if TYPE_CHECKING:  # looking faults up needs no MuJoCo
    from harness.physics.simulation import Simulation

CMD_VEL, MOTOR, WHEEL = "cmd_vel", "motor.", "wheel."  # as faults call them; a side or a wheel follows
CommandEffect = Callable[[Twist, int], Twist]  # what is obeyed at a time [ns] for what was commanded
CommandAct = Callable[[Fault[Any], np.random.Generator], CommandEffect]


class ActuatorFaults:
    """Call `command` with every command and `act` before every tick; faults of sensors are left out."""

    def __init__(self, faults: Iterable[Fault[Any]], seed: int) -> None:
        drawn = [(fault, generator(seed, FAULTS, index)) for index, fault in enumerate(faults)]
        self._commands = [
            (fault, fault.kind.act(fault, rng)) for fault, rng in drawn if fault.sensor == CMD_VEL
        ]
        self._motors = [fault for fault, _ in drawn if fault.sensor.startswith((MOTOR, WHEEL))]

    def command(self, twist: Twist, time_ns: int) -> Twist:
        """Returns the command that reaches the controller."""
        for fault, effect in self._commands:
            passed = effect(twist, time_ns)
            twist = passed if fault.active(time_ns) else twist
        return twist

    def act(self, simulation: "Simulation") -> None:
        """Weakens motors and blocks wheels as they are at the simulation's present time."""
        if not self._motors:
            return
        rover, strength = simulation.scene.rover, dict.fromkeys(("left", "right"), 1.0)
        names = dict(zip(rover.wheel_names, rover.wheel_joints, strict=True))
        stuck = set()
        for fault in (one for one in self._motors if one.active(simulation.time_ns)):
            where = fault.sensor.partition(".")[2]
            if fault.sensor.startswith(WHEEL):
                stuck.add(names[where])
            else:
                strength[where] *= fault.value
        simulation.limit_motors(strength, frozenset(stuck))


def late_commands(fault: Fault[Any], _: np.random.Generator) -> CommandEffect:
    """Each command takes effect a delay [s] later, in order; before that, what was commanded before."""
    waiting: list[tuple[int, Twist]] = []
    last = [Twist()]

    def effect(twist: Twist, time_ns: int) -> Twist:
        waiting.append((time_ns + round(fault.value * NANOSECONDS), twist))
        while waiting and waiting[0][0] <= time_ns:
            last[0] = waiting.pop(0)[1]
        return last[0]

    return effect


def _held_commands(
    share: Callable[[float], float], fault: Fault[Any], rng: np.random.Generator
) -> CommandEffect:
    """A share of the commands is not heard: the last one that was stays in force."""
    last = [Twist()]

    def effect(twist: Twist, time_ns: int) -> Twist:
        lost = fault.active(time_ns) and rng.random() < share(fault.value)
        last[0] = last[0] if lost else twist
        return last[0]

    return effect


lost_commands: CommandAct = partial(_held_commands, lambda value: value)
frozen_commands: CommandAct = partial(_held_commands, lambda _: 1.0)
