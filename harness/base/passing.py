"""How compiled functions get arrays where an integer is all that can be handed to them: as C code does.

A record holds the address, rows and columns of each array, and numbers; its own address is passed.
"""

from harness.base.compiled import IS_COMPILED, inlined  # first: it keeps out what numba would import

# isort: split
import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numba
import numpy as np
from numba.core import cgutils
from numpy.typing import NDArray


def layout(arrays: Sequence[str], numbers: Sequence[str] = ()) -> np.dtype[np.void]:
    """Returns the type of a record: of each array three integers, and the numbers."""
    fields = [(name, np.int64, 3) for name in arrays] + [(name, np.float64) for name in numbers]
    return np.dtype(fields)


def filled(
    of: np.dtype[np.void], arrays: Mapping[str, NDArray[Any]], numbers: Mapping[str, float]
) -> NDArray[np.void]:
    """Returns a record, shape (1,), of contiguous arrays, flat or of rows, which must outlive it."""
    record = np.zeros(1, of)
    fill(record, arrays)
    for name, number in numbers.items():
        record[name] = number
    return record


def fill(record: NDArray[np.void], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Sets arrays of a record, which must outlive it."""
    for name, array in arrays.items():
        record[name] = (array.ctypes.data, *array.shape, 1)[:3]


def _address_as_pointer(_: object, address: object) -> tuple[object, object]:
    def generate(_: object, builder: Any, __: object, args: Any) -> object:  # noqa: ANN401 - numba's
        return builder.inttoptr(args[0], cgutils.voidptr_t)

    return numba.types.voidptr(address), generate


if not IS_COMPILED:

    def pointer(address: int) -> ctypes.c_void_p:
        """Makes an address, an integer, a pointer that numba.carray takes."""
        return ctypes.c_void_p(int(address))

else:
    pointer = numba.extending.intrinsic(_address_as_pointer)


def reader(of: np.dtype[np.void]) -> Callable[[int], Any]:
    """Returns what gives kernels a record of that type by its address."""

    def read(address: int) -> object:
        return numba.carray(pointer(address), (1,), of)[0]

    return inlined(read)


def _array_reader(kind: type[np.generic]) -> Callable[[NDArray[np.int64]], NDArray[Any]]:
    """Returns what gives kernels a two-dimensional array by its three integers in a record."""

    def read(of: NDArray[np.int64]) -> Any:  # noqa: ANN401 - numba has no types
        return numba.carray(pointer(of[0]), (of[1], of[2]), kind)

    return inlined(read)


doubles, singles = _array_reader(np.float64), _array_reader(np.float32)
integers, truths = _array_reader(np.int64), _array_reader(np.bool_)
integers32, integers8 = _array_reader(np.int32), _array_reader(np.int8)
