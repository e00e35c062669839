"""A second core: the ticks of the next control period are simulated while those of this one are read.

MuJoCo steps a copy of the state in a thread that never needs the interpreter; it is woken by a lock of
Python's own that any thread may release, because a thread that had to take the interpreter's lock first
would wait for the thread that reads.
"""

import ctypes
import os
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel, native
from harness.physics.contacts import ContactWatch
from harness.physics.passed_over import SIGNATURE
from harness.physics.scene import Scene
from harness.physics.stepping import Span, Stepping
from harness.physics.steps_kernel import advance, begin_step, is_wrong

CPU_MAX = Path("/sys/fs/cgroup/cpu.max")  # microseconds of all cores in a period of so many, or max
OVER = -1  # instead of where to end: the thread is to end
LONGEST = 10_000  # times that a core is offered to others before one sleeps: some milliseconds
TAKEN_NS = 20_000  # from one offer to the next: others have taken the core, and want it
UNDER_WAY, GOES_ON = -1, -2  # instead of whether a step is begun: nothing has landed

_api = ctypes.pythonapi
_api.PyThread_allocate_lock.restype = ctypes.c_void_p
_api.PyThread_free_lock.argtypes = (ctypes.c_void_p,)
_ACQUIRE, _RELEASE = (
    ctypes.cast(function, ctypes.c_void_p).value or 0
    for function in (_api.PyThread_acquire_lock, _api.PyThread_release_lock)
)
_acquire = native(ctypes.c_void_p, ctypes.c_int)
_release = native(ctypes.c_void_p)
_yield, _tell_time = native(), native(ctypes.c_int, ctypes.c_void_p)
CLOCK = getattr(time, "CLOCK_MONOTONIC", 0)
_SYSTEM = 0, 0  # the addresses of sched_yield and clock_gettime
if hasattr(os, "sched_yield"):  # not on Windows
    _C = ctypes.CDLL(None)
    _SYSTEM = (
        ctypes.cast(_C.sched_yield, ctypes.c_void_p).value or 0,
        ctypes.cast(_C.clock_gettime, ctypes.c_void_p).value or 0,
    )
_wait = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int)(_ACQUIRE)  # without the interpreter's lock


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


@kernel("void(int64[::1], boolean, UniTuple(int64, 2))")
def stay_awake(steps: NDArray[np.int64], is_under_way: bool, system: tuple[int, int]) -> None:
    """Waits until steps have landed or are launched, others want the core, or one may as well sleep.

    Args:
        steps: As `serve` has them.
        is_under_way: Whether it is waited for steps under way to land; else for steps to be launched.
        system: Addresses of sched_yield and clock_gettime.
    """
    clock = np.zeros(2, np.int64)  # seconds and nanoseconds
    before = np.int64(0)
    for tries in range(LONGEST):
        if (steps[3] < 0) != is_under_way:
            return
        _yield(system[0], ())
        _tell_time(system[1], (CLOCK, clock.ctypes.data))
        now = clock[0] * 1_000_000_000 + clock[1]
        if tries and now - before > TAKEN_NS:
            return
        before = now


@kernel(
    "void(UniTuple(int64, 4), UniTuple(int64, 2), int64[::1], Tuple((UniTuple(int64, 6),"
    "Tuple((float64[::1], int64[::1], float64[:,::1])), Tuple((int32[:], float64[:,::1])),"
    "Tuple((float64[::1], float64[:,::1])), Tuple((UniTuple(float64[::1], 3),"
    "UniTuple(float64[:,::1], 3))), Tuple((int32[::1], float64[:,::1], int32[:,::1], int64[::1])),"
    f"Tuple((int64[:,::1], int8[:,::1], int64[::1], float64[:,:,:,::1])), {SIGNATURE})))"
)
def serve(
    locks: tuple[int, int, int, int],
    system: tuple[int, int],
    steps: NDArray[np.int64],
    stepping: Stepping,
) -> None:
    """Advances whenever the first lock is released, then releases the second; ends at OVER.

    Args:
        locks: The two locks, and the addresses of what takes and what releases them.
        system: As `stay_awake` has it, to wait awake; zeros to sleep.
        steps: Where to begin and to end, and steps of a tick, as `advance` has them; GOES_ON to begin
            the step after them, too, if all is well, or else UNDER_WAY. Afterwards where it ended comes
            first, and last 1 if that step is begun, or else 0.
        stepping: What `advance` takes beside them; contacts must be known.
    """
    pointers, control, health, felt, recorded, contacts, watched, obstacles = stepping
    is_begun = False
    while True:
        _acquire(locks[2], (locks[0], 1))
        if steps[1] == OVER:
            return
        span = (steps[0], steps[1], steps[2], int(is_begun))
        steps[0] = advance(pointers, span, control, health, felt, recorded, contacts, watched, obstacles)
        is_begun = steps[3] == GOES_ON and not is_wrong(health, recorded[0][0])
        steps[3] = int(is_begun)
        _release(locks[3], (locks[1],))
        if is_begun:  # meanwhile somebody decides what is commanded
            begin_step(pointers, recorded[0], obstacles)
            if system[0]:
                stay_awake(steps, False, system)


class Aside:
    """A thread that steps a state while this one does something else.

    Args:
        span: Gets what the ticks are like.
        contacts: What is touched in them; known where they are watched.
        awake: Whether the two wait for each other awake, but behind whoever else wants their cores: who
            sleeps for half a millisecond finds its caches cold, and is woken late.
    """

    def __init__(self, span: Span, contacts: ContactWatch, *, awake: bool = False) -> None:
        self._steps = np.zeros(4, np.int64)
        self._locks = tuple(_api.PyThread_allocate_lock() for _ in range(2))
        for lock in self._locks:
            _wait(lock, 1)
        self._system = _SYSTEM if awake else (0, 0)
        locks = (*self._locks, _ACQUIRE, _RELEASE)
        args = locks, self._system, self._steps, span.arguments(contacts)
        self._thread = threading.Thread(target=serve, args=args, daemon=True)
        self._thread.start()

    def launch(self, steps: int, per_tick: int, *, goes_on: bool = False) -> None:
        """Begins to simulate steps under the commands of the span.

        Args:
            steps: How many.
            per_tick: Steps of a tick.
            goes_on: Whether to begin the step after them, too; the next launch waits until it is begun.
        """
        self._steps[:] = 0, steps, per_tick, GOES_ON if goes_on else UNDER_WAY
        _api.PyThread_release_lock(ctypes.c_void_p(self._locks[0]))

    def land(self) -> int:
        """Waits for what was launched; returns where it ended, as `Span.advance`."""
        if self._system[0]:
            stay_awake(self._steps, is_under_way=True, system=self._system)
        _wait(self._locks[1], 1)
        return int(self._steps[0])

    @property
    def has_begun(self) -> bool:
        """Whether the step after those that have landed is begun; False while they are under way."""
        return int(self._steps[3]) == 1

    def close(self) -> None:
        """Ends the thread, which must have landed; nothing is launched any more."""
        self.launch(OVER, 0)
        self._thread.join()
        for lock in self._locks:
            _api.PyThread_free_lock(ctypes.c_void_p(lock))


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
        self._data, self.is_away = mujoco.MjData(self._model), False
        self._contacts = ContactWatch(scenes, self._data)
        self._span = Span(self._model, self._data, span.motors, span.obstacles)
        self._span.fence, self._strongest = span.fence, self._contacts.watched[-1]
        self._aside: Aside | None = None
        self._awake = awake
        # Its steps have no halves that could be taken one after the other.
        self._goes_on = self._model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4

    def launch(self, steps: int, per_tick: int) -> bool:
        """Begins to simulate steps under the commands of the span.

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
            self._aside = Aside(self._span, self._contacts, awake=self._awake)
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
        contacts.begin()
        contacts.watched[-1][:] = self._strongest
        span.take(self._span)
        if not self._has_begun and self._span.is_wrong():
            self.come_back()
        return ended

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
