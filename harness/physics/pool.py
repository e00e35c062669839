"""Threads that step worlds side by side: whoever is free takes the next one, without the interpreter."""

import threading
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, Protocol
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from harness.base import native_lock
from harness.base.compiled import inlined, kernel
from harness.base.native_lock import release_natively, take_natively
from harness.physics.steps_kernel import advance

# Of each slot: locks that are released when it may be stepped, and when a thread of the pool has done
# it; what `advance` takes, where to end and steps of a tick; where it ended.
READY, DONE, STEPPING, END, PER_TICK, ENDED = range(6)
LOCKS = native_lock.ACQUIRE, native_lock.RELEASE


class Offer(NamedTuple):
    """Steps of a world that any thread may do.

    Attributes:
        stepping: The address that `steps_kernel.advance` takes.
        steps: How many.
        per_tick: Steps of a tick.
    """

    stepping: int
    steps: int
    per_tick: int


class World(Protocol):
    """A world that may be stepped by others."""

    def offer(self) -> Offer | None:
        """Returns what it would do in its next `run`; None if it has to do that itself."""

    def take(self, ended: int) -> None:
        """Takes note that its steps are done, up to that one."""


@inlined
def _step_if_free(acquire: int, slots: NDArray[np.int64], slot: int) -> bool:
    """Steps the world of a slot, unless somebody else has begun; returns whether it did."""
    is_free = take_natively(acquire, slots[slot, READY], 0)
    if is_free:
        row = slots[slot]
        row[ENDED] = advance(row[STEPPING], (0, row[END], row[PER_TICK], 0))
    return is_free


@kernel("boolean(int64, int64[:,::1], int64)")
def step_if_free(acquire: int, slots: NDArray[np.int64], slot: int) -> bool:
    """Steps the world of a slot, unless somebody else has begun; returns whether it did.

    Args:
        acquire: Address of what takes locks.
        slots: Of the pool.
        slot: Which of them.
    """
    return _step_if_free(acquire, slots, slot)


@kernel("void(UniTuple(int64, 2), int64[::1], int64[:,::1])")
def work(locks: tuple[int, int], bell: NDArray[np.int64], slots: NDArray[np.int64]) -> None:
    """Steps what is free whenever the bell rings, until it rings for the last time.

    Args:
        locks: Addresses of what takes and of what releases locks.
        bell: A lock that is released to ring; then, whether that was the last time.
        slots: Of the pool.
    """
    while True:
        take_natively(locks[0], bell[0], 1)
        if bell[1]:
            return
        for slot in range(slots.shape[0]):
            if _step_if_free(locks[0], slots, slot):
                release_natively(locks[1], slots[slot, DONE])


class Pool:
    """Threads that step worlds, together with the one that uses them.

    Args:
        slots: How many worlds at most.
        threads: How many threads beside that one.
    """

    def __init__(self, slots: int, threads: int) -> None:
        self._slots = np.zeros((slots, 6), np.int64)
        for row in self._slots:
            row[READY], row[DONE] = native_lock.taken_lock(), native_lock.taken_lock()
        self._bells = [np.array([native_lock.taken_lock(), 0]) for _ in range(threads)]
        made = [
            threading.Thread(target=work, args=(LOCKS, bell, self._slots), daemon=True)
            for bell in self._bells
        ]
        for thread in made:
            thread.start()
        self.close = finalize(self, _close, self._slots, self._bells, made)  # nobody has to say it

    def step(self, worlds: Iterable[World]) -> Iterator[int]:
        """Has worlds stepped that offer it, the first ones while others are still made ready.

        Yields:
            The place of each, as they come, in any order; those that offer nothing come first.
        """
        given, alone, begun = list[World](), list[int](), deque[int]()
        try:
            for place, world in enumerate(worlds):
                given.append(world)
                if (offer := world.offer()) is None:
                    alone.append(place)
                    continue
                row = self._slots[place]
                row[STEPPING:ENDED] = offer
                native_lock.release(int(row[READY]))
                begun.append(place)
                if len(begun) == 1:
                    _ring(self._bells)
            _ring(self._bells)
            yield from alone
            while begun:
                yield self._next(begun, given)
        finally:  # also where somebody stops in between
            while begun:
                self._next(begun, given)

    def _next(self, begun: deque[int], worlds: Sequence[World]) -> int:
        """Waits for a world, or steps the last one if nobody has begun it; returns its place."""
        first, last = begun[0], begun[-1]
        done = int(self._slots[first, DONE])
        is_done = native_lock.take(done, waits=False)
        if not is_done and step_if_free(LOCKS[0], self._slots, last):
            place = begun.pop()
        else:
            place = begun.popleft()
            if not is_done:
                native_lock.take(done)
        worlds[place].take(int(self._slots[place, ENDED]))
        return place


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
    for lock in (*slots[:, : DONE + 1].ravel().tolist(), *(int(bell[0]) for bell in bells)):
        native_lock.free(lock)
