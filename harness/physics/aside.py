"""A thread that steps a state while another one does something else, and never needs the interpreter."""

import ctypes
import os
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base import native_lock
from harness.base.compiled import entry, kernel, native, run_entry
from harness.base.native_lock import release_natively, take_natively
from harness.physics.contacts import ContactWatch
from harness.physics.stepping import Span
from harness.physics.stepping_record import BEGIN, END, ENDED, IS_BEGUN, RECORD
from harness.physics.steps_kernel import advance, begin_step, is_wrong

OVER = -1  # instead of where to end: the thread is to end
LONGEST = 10_000  # times that a core is offered to others before one sleeps: some milliseconds
TAKEN_NS = 20_000  # from one offer to the next: others have taken the core, and want it
UNDER_WAY, GOES_ON = -1, -2  # instead of whether a step is begun: nothing has landed
DUE, DONE = 1, 2  # an errand
NEXT = ENDED + 1  # behind what `advance` takes

_yield, _tell_time = native(), native(ctypes.c_int, ctypes.c_void_p)
CLOCK = getattr(time, "CLOCK_MONOTONIC", 0)
_SYSTEM = 0, 0  # the addresses of sched_yield and clock_gettime
if hasattr(os, "sched_yield"):  # not on Windows
    _C = ctypes.CDLL(None)
    _SYSTEM = (
        ctypes.cast(_C.sched_yield, ctypes.c_void_p).value or 0,
        ctypes.cast(_C.clock_gettime, ctypes.c_void_p).value or 0,
    )


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
        if (steps[NEXT] < 0) != is_under_way:
            return
        _yield(system[0], ())
        _tell_time(system[1], (CLOCK, clock.ctypes.data))
        now = clock[0] * 1_000_000_000 + clock[1]
        if tries and now - before > TAKEN_NS:
            return
        before = now


@kernel("void(UniTuple(int64, 5), UniTuple(int64, 2), int64[::1], int64[:,::1])")
def serve(
    addresses: tuple[int, int, int, int, int],
    system: tuple[int, int],
    steps: NDArray[np.int64],
    errands: NDArray[np.int64],
) -> None:
    """Advances whenever the first lock is released, then releases the second; ends at OVER.

    Args:
        addresses: Of the two locks, of what takes and what releases them, of the `entry` of `advance`.
        system: As `stay_awake` has it, to wait awake; zeros to sleep.
        steps: What `advance` takes, of a record whose contacts are known; then GOES_ON to begin the step
            after them, too, if all is well, or else UNDER_WAY. Afterwards where it ended comes
            last but one, and last 1 if that step is begun, or else 0.
        errands: Of each that may be due: as `Errand.passed` has it, and DUE, which becomes DONE if all
            steps could be made.
    """
    is_begun, result = False, np.zeros(1, np.int64)  # of a kernel: None, and no error
    while True:
        take_natively(addresses[2], addresses[0], 1)
        if steps[END] == OVER:
            return
        steps[IS_BEGUN] = int(is_begun)
        run_entry(addresses[4], (result.ctypes.data, result.ctypes.data, steps.ctypes.data))
        for row in range(errands.shape[0]):
            if errands[row, 2] == DUE and steps[ENDED] == steps[END]:
                run_entry(errands[row, 0], (result.ctypes.data, result.ctypes.data, errands[row, 1]))
                errands[row, 2] = DONE
        is_begun = steps[NEXT] == GOES_ON and not is_wrong(steps[RECORD])
        steps[NEXT] = int(is_begun)
        release_natively(addresses[3], addresses[1])
        if is_begun:  # meanwhile somebody decides what is commanded
            begin_step(steps[RECORD])
            if system[0]:
                stay_awake(steps, False, system)


@dataclass(eq=False)
class Errand:
    """Something that the thread which steps does with the state at the end, without the interpreter."""

    # returns the `entry` of a kernel that never fails and what it takes, for a state; asked for once,
    # they must hold as long as the state is stepped
    passed: Callable[[mujoco.MjData], tuple[int, int]]
    is_done: bool = False  # whether it is done since it was ordered


class Aside:
    """A thread that steps a state while this one does something else.

    Args:
        span: Gets what the ticks are like.
        contacts: What is touched in them; known where they are watched.
        errands: How many may be ordered.
        awake: Whether the two wait for each other awake, but behind whoever else wants their cores: who
            sleeps for half a millisecond finds its caches cold, and is woken late.
    """

    def __init__(
        self, span: Span, contacts: ContactWatch, *, errands: int = 0, awake: bool = False
    ) -> None:
        self._steps, rows = np.zeros(NEXT + 1, np.int64), np.zeros((errands, 3), np.int64)
        self._steps[RECORD] = span.passed(contacts)
        self._free, self._errands = list(rows), dict[Errand, NDArray[np.int64]]()
        self._locks = native_lock.taken_lock(), native_lock.taken_lock()
        self._system = _SYSTEM if awake else (0, 0)
        addresses = (*self._locks, native_lock.ACQUIRE, native_lock.RELEASE, entry(advance))
        args = addresses, self._system, self._steps, rows
        self._thread = threading.Thread(target=serve, args=args, daemon=True)
        self._thread.start()

    def order(self, errand: Errand, data: mujoco.MjData) -> None:
        """Has an errand done with the state, at the end of what is launched next."""
        if errand not in self._errands:
            self._errands[errand] = row = self._free.pop()
            row[:2] = errand.passed(data)
        self._errands[errand][2] = DUE

    def launch(self, steps: int, per_tick: int, *, goes_on: bool = False) -> None:
        """Begins to simulate steps under the commands of the span.

        Args:
            steps: How many.
            per_tick: Steps of a tick.
            goes_on: Whether to begin the step after them, too; the next launch waits until it is begun.
        """
        self._steps[BEGIN:IS_BEGUN] = 0, steps, per_tick
        self._steps[NEXT] = GOES_ON if goes_on else UNDER_WAY
        native_lock.release(self._locks[0])

    def land(self) -> int:
        """Waits for what was launched; returns where it ended, as `Span.advance`."""
        if self._system[0] and self.is_under_way:
            stay_awake(self._steps, is_under_way=True, system=self._system)
        native_lock.take(self._locks[1])
        for errand, row in self._errands.items():
            errand.is_done, row[2] = bool(row[2] == DONE), 0
        return int(self._steps[ENDED])

    @property
    def is_under_way(self) -> bool:
        """Whether what was launched is not done yet."""
        return int(self._steps[NEXT]) < 0

    @property
    def has_begun(self) -> bool:
        """Whether the step after those that have landed is begun; False while they are under way."""
        return int(self._steps[NEXT]) == 1

    def close(self) -> None:
        """Ends the thread, which must have landed; nothing is launched any more."""
        self.launch(OVER, 0)
        self._thread.join()
        for lock in self._locks:
            native_lock.free(lock)
