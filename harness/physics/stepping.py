"""The clock ticks that are simulated in one go: what is commanded before, what each was like after."""

import mujoco
import numpy as np

from harness.base.passing import fill, filled
from harness.physics.c_functions import addresses
from harness.physics.contacts import ContactWatch
from harness.physics.passed_over import PassedOver
from harness.physics.stepping_record import (
    CONTACTS,
    ENDED,
    OWN,
    SPAN,
    STATE,
    STEPPING,
    Doubles,
    Integers,
)
from harness.physics.steps_kernel import advance, is_wrong


class Span:
    """Steps a model through the ticks of a control period, or fewer, and knows what they were like.

    Args:
        model: The compiled scene.
        data: Its state.
        motors: Controls that are commanded.
        obstacles: Those that are passed over while no rover can touch them.
        fence: Where each rover's pose stands in qpos, and x from, x to, y from, y to between which it
            may be [m], shape (rovers, 5).

    Attributes:
        motors: Controls that are commanded.
        obstacles: As given.
        fence: As given.
        commands: To them in each tick, shape (SPAN, motors).
        warnings: MuJoCo's counters of them.
        sums: MuJoCo's sensor values summed over the steps of each tick, shape (SPAN, sensors).
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        motors: Integers,
        obstacles: PassedOver,
        fence: Doubles,
    ) -> None:
        self.motors, self.commands = motors, np.zeros((SPAN, motors.size))
        self.obstacles, self.fence = obstacles, fence
        self.warnings = data.warning.number  # a view: MuJoCo counts up in it
        self.sums = np.zeros((SPAN, data.sensordata.size))
        self._state: tuple[Doubles, ...] = tuple(getattr(data, name) for name in STATE)
        self._record = tuple(np.zeros((SPAN, part.size)) for part in self._state)
        pointers = np.array([*addresses(), model._address, data._address])  # noqa: SLF001 - no other name
        last = data.warning.lastinfo  # stands before each counter
        counters = np.lib.stride_tricks.as_strided(last, (last.size, 2), (*last.strides, last.itemsize))
        commands = data.ctrl, motors, self.commands
        discs, geoms, bodies, bits, rovers, reach = obstacles
        passed = discs, geoms, bodies, *bits, rovers, reach
        felt = data.sensordata, self.sums
        own = pointers, *commands, counters, fence, *felt, *self._state, *self._record, *passed
        self._kept = dict(zip(OWN, own, strict=True))
        self._passed = filled(STEPPING, self._kept, {})
        self._address = int(self._passed.ctypes.data)
        self._steps = np.zeros(ENDED + 1, np.int64)
        self._steps_at = int(self._steps.ctypes.data)
        self._watched: tuple[object, object] = None, None

    def advance(self, steps: tuple[int, int, int], watch: ContactWatch) -> int:
        """Steps to the end, or until a tick after which there are warnings or a rover left its fence.

        Args:
            steps: Where to begin and to end, counted from the first tick's first step; steps of a tick.
            watch: Learns what is touched.

        Returns:
            Where it ended, counted as in `steps`.
        """
        step, end, per_tick = steps
        while True:
            self._steps[:] = self.passed(watch), step, end, per_tick, 0, 0
            advance(self._steps_at)
            step = int(self._steps[ENDED])
            if step >= 0:
                return step
            step = -step
            watch.look((step - 1) // per_tick)

    def passed(self, watch: ContactWatch) -> int:
        """Returns the address of its record, which is right as long as both are kept."""
        contacts, watched = self._watched
        if watch.contacts is not contacts or watch.watched is not watched:
            self._watched = watch.contacts, watch.watched
            fill(self._passed, dict(zip(CONTACTS, (*watch.contacts, *watch.watched), strict=True)))
        return self._address

    def is_wrong(self) -> bool:
        """Returns whether there are warnings, or a rover left its fence."""
        return is_wrong(self._address)

    def take(self, other: "Span") -> None:
        """Takes over what the ticks of another span were like, one of the same model."""
        self.sums[:] = other.sums
        for part, values in zip(self._record, other._record, strict=True):  # noqa: SLF001 - its class
            part[:] = values

    def path(self, at: int) -> list[list[float]]:
        """Returns what a rover's pose, which stands there in qpos, was at the end of each tick."""
        path: list[list[float]] = self._record[0][:, at : at + 7].tolist()
        return path

    def show(self, tick: int, sums: Doubles) -> None:
        """Sets what STATE names to what it was at the end of a tick, and the sums of its sensors."""
        for part, values in zip(self._state, self._record, strict=True):
            part[:] = values[tick]
        sums[:] = self.sums[tick]
