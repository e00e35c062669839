"""A second core: the ticks of the next control period are simulated while those of this one are read."""

import os
from collections.abc import Sequence
from pathlib import Path

import mujoco

from harness.physics.aside import Aside, Errand
from harness.physics.contacts import ContactWatch
from harness.physics.scene import Scene
from harness.physics.stepping import Span

CPU_MAX = Path("/sys/fs/cgroup/cpu.max")  # microseconds of all cores in a period of so many, or max


def has_second_core() -> bool:
    """Returns whether this process may use two cores: by its affinity, and by its container's limit."""
    usable = getattr(os, "sched_getaffinity", None)  # not on macOS, nor on Windows
    if (os.cpu_count() or 1 if usable is None else len(usable(0))) == 1:
        return False
    try:
        most, period = CPU_MAX.read_text().split()
    except (OSError, ValueError):
        return True  # nothing limits it
    return most == "max" or int(most) >= 2 * int(period)


class Ahead:
    """Steps a copy of a world's state, which is the newer one from `launch` to `come_back`.

    Args:
        scenes: Of the rovers, in one model.
        data: The state that everybody reads.
        span: What is known of its ticks; gets what the copy's were like.
        contacts: What is touched in them, of the copy as of the state that is read.
        awake: How they wait for each other, as `Aside` has it.

    Attributes:
        is_away: Whether the copy is newer than what everybody reads.
        is_well: Whether all was well at the end of what has landed.
    """

    def __init__(
        self,
        scenes: Sequence[Scene],
        data: mujoco.MjData,
        span: Span,
        contacts: ContactWatch,
        *,
        awake: bool,
    ) -> None:
        self._model, self._read, self._shown = scenes[0].model, data, (span, contacts)
        self._data, self.is_away, self.is_well = mujoco.MjData(self._model), False, True
        self._contacts = ContactWatch(scenes, self._data)
        self._span = Span(self._model, self._data, span.motors, span.obstacles, span.fence)
        self._strongest = self._contacts.watched[-1]
        self._aside: Aside | None = None
        self._awake, self._most = awake, len(scenes)
        # Its steps have no halves that could be taken one after the other.
        self._goes_on = self._model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4

    def launch(self, steps: int, per_tick: int, errands: Sequence[Errand] = ()) -> bool:
        """Begins to simulate steps under the commands of the span.

        Args:
            steps: How many.
            per_tick: Steps of a tick.
            errands: Are done with the state at their end, if all can be made.

        Returns:
            Whether it could: before the first contact nobody knows where MuJoCo keeps them.
        """
        if not self.is_away:
            mujoco.mj_copyData(self._data, self._model, self._read)
            self.is_away = True
        if self._aside is None:
            if not self._contacts.are_known():
                self.come_back()
                return False
            self._aside = Aside(self._span, self._contacts, errands=self._most, awake=self._awake)
        for errand in errands:
            self._aside.order(errand, self._data)
        self._span.commands[:] = self._shown[0].commands
        self._strongest[..., 0] = 0.0
        self._aside.launch(steps, per_tick, goes_on=self._goes_on)
        return True

    def land(self) -> int:
        """Waits for what was launched; returns where it ended, as `Span.advance`.

        What the ticks were like is then with the span and the contacts of the state that is read.
        """
        ended = 0 if self._aside is None else self._aside.land()
        span, contacts = self._shown
        contacts.take(self._strongest)
        span.take(self._span)
        self.is_well = self._has_begun or not self._span.is_wrong()
        if not self.is_well:
            self.come_back()
        return ended

    @property
    def has_landed(self) -> bool:
        """Whether what was launched is done."""
        return self._aside is not None and not self._aside.is_under_way

    @property
    def _has_begun(self) -> bool:
        return self._aside is not None and self._aside.has_begun

    def halt(self) -> None:
        """Takes back the step that is begun while commands are decided: friction may change then."""
        if self._aside is not None and self._has_begun:
            self._aside.launch(0, 1)
            self._aside.land()
            self._span.warnings[:] = 0  # there were none, or it would not have been begun

    def come_back(self) -> None:
        """Makes the state that is read the newest one again."""
        self.halt()
        if self.is_away:
            mujoco.mj_copyData(self._read, self._model, self._data)
            self.is_away = False

    def close(self) -> None:
        """Ends the thread, which must have landed; nothing is launched any more."""
        if self._aside is not None:
            self._aside.close()
