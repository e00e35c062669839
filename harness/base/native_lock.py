"""Locks that compiled code takes and releases without the interpreter: Python's own, by their addresses.

A thread that had to take the interpreter's lock first would wait for the thread that reads.
"""

import ctypes

from harness.base.compiled import inlined, native

_api = ctypes.pythonapi
_api.PyThread_allocate_lock.restype = ctypes.c_void_p
_api.PyThread_free_lock.argtypes = (ctypes.c_void_p,)
_api.PyThread_release_lock.argtypes = (ctypes.c_void_p,)
ACQUIRE, RELEASE = (
    ctypes.cast(function, ctypes.c_void_p).value or 0
    for function in (_api.PyThread_acquire_lock, _api.PyThread_release_lock)
)
_acquire = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int)(ACQUIRE)
_acquire_natively = native(ctypes.c_void_p, ctypes.c_int, answers=True)
_release_natively = native(ctypes.c_void_p)

free = _api.PyThread_free_lock
release = _api.PyThread_release_lock


def taken_lock() -> int:
    """Returns the address of a new lock, which is taken; it is to be given to `free`."""
    lock = int(_api.PyThread_allocate_lock())
    take(lock)
    return lock


def take(lock: int) -> None:
    """Takes the lock at an address, when somebody has released it; without the interpreter meanwhile."""
    _acquire(lock, 1)


@inlined
def take_natively(acquire: int, lock: int, waits: int) -> bool:
    """Takes a lock in compiled code; returns whether it could.

    Args:
        acquire: ACQUIRE, which is another one in each process.
        lock: Its address.
        waits: 1 to wait until somebody releases it, 0 for not.
    """
    answer: int = _acquire_natively(acquire, (lock, waits))
    return answer != 0


@inlined
def release_natively(release: int, lock: int) -> None:
    """Releases a lock in compiled code; `release` is RELEASE, another one in each process."""
    _release_natively(release, (lock,))
