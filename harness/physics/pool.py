"""Threads that step worlds side by side: whoever is free takes the next one, without the interpreter."""

import threading
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from harness.base import native_lock
from harness.base.compiled import entry, inlined, kernel, run_entry
from harness.base.native_lock import release_natively, take_natively
from harness.physics.stepping_record import ENDED
from harness.physics.steps_kernel import advance

if TYPE_CHECKING:
    from harness.physics.physics import Physics

# Of each slot, behind what `advance` takes: a lock that is released when it may be stepped, and taken by
# who steps it; one that is released when a thread of the pool has done so; NONE, BEGUN or STEPPED.
READY, DONE, STATE = range(ENDED + 1, ENDED + 4)
NONE, BEGUN, STEPPED = range(3)  # nothing is offered; any thread may step it; this one knows that it is


@inlined
def _step(addresses: tuple[int, int, int], row: NDArray[np.int64]) -> bool:
    """Steps the world of a slot unless somebody else has begun; returns whether it did."""
    if not take_natively(addresses[0], row[READY], 0):
        return False
    result = np.zeros(1, np.int64)  # None, and no error
    run_entry(addresses[2], (result.ctypes.data, result.ctypes.data, row.ctypes.data))
    return True


@kernel("void(UniTuple(int64, 3), int64[::1], int64[:,::1])")
def work(addresses: tuple[int, int, int], bell: NDArray[np.int64], slots: NDArray[np.int64]) -> None:
    """Steps what may be stepped whenever the bell rings, until it rings for the last time.

    Args:
        addresses: Of what takes and what releases locks, of the `entry` of `advance`.
        bell: A lock that is released to ring; then, whether that was the last time.
        slots: Of the pool.
    """
    while True:
        take_natively(addresses[0], bell[0], 1)
        if bell[1]:
            return
        for slot in range(slots.shape[0]):
            if _step(addresses, slots[slot]):
                release_natively(addresses[1], slots[slot, DONE])


@kernel("void(UniTuple(int64, 3), int64[::1])")
def begin(addresses: tuple[int, int, int], row: NDArray[np.int64]) -> None:
    """Lets any thread step the world of a slot; as one call, which no signal interrupts half-way."""
    row[STATE] = BEGUN
    release_natively(addresses[1], row[READY])


@kernel("void(UniTuple(int64, 3), int64[::1], int64[::1])")
def end_one(addresses: tuple[int, int, int], first: NDArray[np.int64], last: NDArray[np.int64]) -> None:
    """Makes one of those that are BEGUN STEPPED; as one call, which no signal interrupts half-way.

    The last one is stepped here if the first one is not done yet, and nobody else has begun the last.
    """
    if take_natively(addresses[0], first[DONE], 0):
        first[STATE] = STEPPED
    elif _step(addresses, last):
        last[STATE] = STEPPED
    else:
        take_natively(addresses[0], first[DONE], 1)
        first[STATE] = STEPPED


class Pool:
    """Threads that step worlds, together with the one that uses them.

    Args:
        slots: How many worlds at most.
        threads: How many threads beside that one.
    """

    def __init__(self, slots: int, threads: int) -> None:
        self._slots = np.zeros((slots, STATE + 1), np.int64)
        for row in self._slots:
            row[READY], row[DONE] = native_lock.taken_lock(), native_lock.taken_lock()
        self._addresses = native_lock.ACQUIRE, native_lock.RELEASE, entry(advance)
        self._bells = [np.array([native_lock.taken_lock(), 0]) for _ in range(threads)]
        made = [
            threading.Thread(target=work, args=(self._addresses, bell, self._slots), daemon=True)
            for bell in self._bells
        ]
        for thread in made:
            thread.start()
        self._worlds: list[Physics] = []
        self.close = finalize(self, _close, self._slots, self._bells, made)  # nobody has to say it

    def step(self, worlds: "Iterable[Physics]") -> Iterator[int]:
        """Has worlds stepped that offer it, the first ones while others are still made ready.

        Yields:
            The place of each, as they come, in any order; those that offer nothing come first.
        """
        self._settle()
        alone = list[int]()
        try:
            for place, world in enumerate(worlds):
                self._worlds.append(world)
                if (offer := world.offer()) is None:
                    alone.append(place)
                    continue
                row = self._slots[place]
                row[: len(offer)] = offer
                begin(self._addresses, row)
                if place == len(alone):  # the first one
                    _ring(self._bells)
            _ring(self._bells)
            yield from alone
            yield from self._ended()
        finally:
            self._settle()

    def _settle(self) -> None:
        """Has those stepped to the end that somebody who stopped in between left behind."""
        for _ in self._ended():
            pass
        self._worlds = []  # which may be large, and over

    def _ended(self) -> Iterator[int]:
        """Yields the places of worlds that are begun, as they are stepped by whomever."""
        rows = self._slots
        while (left := np.flatnonzero(rows[:, STATE])).size:
            if not (rows[left, STATE] == STEPPED).any():
                end_one(self._addresses, rows[left[0]], rows[left[-1]])
            for place in left[rows[left, STATE] == STEPPED].tolist():
                self._worlds[place].take(int(rows[place, ENDED]))
                rows[place, STATE] = NONE
                yield place


def _ring(bells: Sequence[NDArray[np.int64]]) -> None:
    for bell in bells:
        native_lock.release(int(bell[0]))


def _close(
    slots: NDArray[np.int64], bells: Sequence[NDArray[np.int64]], threads: Sequence[threading.Thread]
) -> None:
    for bell in bells:
        bell[1] = 1
    _ring(bells)
    for thread in threads:
        thread.join()
    for lock in (*slots[:, [READY, DONE]].ravel().tolist(), *(int(bell[0]) for bell in bells)):
        native_lock.free(lock)
