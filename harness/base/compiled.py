"""How kernels are compiled: at import or from the cache on disk, never at the first scan."""

import ctypes
import os
import stat
import sys
import tempfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial
from multiprocessing import parent_process
from pathlib import Path
from typing import Any, TypeVar


@contextmanager
def _kept_out(*names: str) -> Iterator[None]:
    """Makes imports of these modules fail, unless they are imported already."""
    absent = [name for name in names if name not in sys.modules]
    sys.modules.update(dict.fromkeys(absent))  # type: ignore[arg-type]  # None makes an import fail
    yield
    for name in absent:
        del sys.modules[name]


# numba imports them wherever they are installed: a tenth of each start, for nothing.
with _kept_out("coverage", "scipy.linalg", "yaml"):
    import llvmlite.binding as llvm
    import numba
    import numba.np.arraymath
    from numba.core import cgutils, event
numba.np.arraymath._HAVE_BLAS = True  # noqa: SLF001 - kernels of others find it when they need it

IS_COMPILED = not numba.config.DISABLE_JIT

_kept: list[object] = []  # as long as C may call them

F = TypeVar("F", bound=Callable[..., object])


class _Notice(event.Listener):  # type: ignore[misc]  # numba has no types for mypy
    """Says on a terminal, once a program, what takes so long: a kernel in no cache is being compiled."""

    _is_due = True  # a listener that unregisters itself makes numba skip the next one

    def on_start(self, event: Any) -> None:  # noqa: ANN401 - numba's
        """Is called when a compilation begins, of kernels and of functions of users."""
        module = event.data["dispatcher"].py_func.__module__  # None of a function that exec has made
        if self._is_due and module is not None and module.startswith("harness."):
            self._is_due = False
            is_worker = parent_process() is not None  # whose program has said so
            if not is_worker and sys.stderr is not None and sys.stderr.isatty():
                print("harness: compiling its kernels, once after each update", file=sys.stderr)

    def on_end(self, event: Any) -> None:  # noqa: ANN401 - numba's
        """Is called when a compilation ends."""


event.register("numba:compile", _Notice())


def kernel(signature: str | None = None) -> Callable[[F], F]:
    """Compiles a function for one signature; it releases the GIL, its code is kept in __pycache__.

    Without a signature it is compiled when it is first called. A kernel that only others call, which
    hold its code, is then not loaded at a start.

    Numba renews the cache when the kernel's own file changes, and only then: so the name in the cache
    tells what else a kernel is made of, the files of its `inlined` helpers and the numbers it names. No
    fastmath, no threads: equal input gives equal bits, those of Python itself (NUMBA_DISABLE_JIT).

    Where neither __pycache__ nor the user's cache can be written, as in a container that is run by
    another user than built it, the code is kept in a temporary folder, or not at all.
    """
    return partial(
        _cached, partial(numba.njit, *filter(None, [signature]), nogil=True, error_model="numpy")
    )


def callback(signature: str) -> Callable[[F], F]:
    """Compiles as `kernel` does, for C code, which calls the attribute `ctypes` of the result."""
    return partial(_cached, partial(numba.cfunc, signature, error_model="numpy"))


def _cached(compiler: Callable[..., Callable[[F], F]], function: F) -> F:
    """Compiles a function, or loads what was compiled of the same sources before."""
    if borrowed := _borrowed(function):
        function.__qualname__ += f"_{zlib.crc32(borrowed):08x}"
    try:
        return compiler(cache=True)(function)
    except RuntimeError:  # numba's "no locator available"
        folder = _temporary_cache()
        numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"] = folder or ""
        return compiler(cache=folder is not None)(function)


def _borrowed(function: Callable[..., object]) -> bytes:
    """What a kernel depends on beside its own file: its helpers' files, and numbers that they name."""
    functions, numbers = [function], set[str]()
    for each in functions:  # grows
        for name in each.__code__.co_names:
            value = each.__globals__.get(name)
            helper = getattr(value, "py_func", None)
            if helper is not None and helper not in functions:
                functions.append(helper)
            elif isinstance(value, int | float):
                numbers.add(f"{name} {value!r}")
    files = {each.__code__.co_filename for each in functions} - {function.__code__.co_filename}
    contents = (Path(file).read_bytes() for file in sorted(files))
    return b"".join((*contents, *(number.encode() for number in sorted(numbers))))


def _temporary_cache() -> str | None:
    """A folder that is this user's alone, since numba unpickles what it finds; None if there is none.

    A line on stderr says that it is new, or that there is none.
    """
    user = getattr(os, "getuid", lambda: None)()  # Windows has none, nor needs one
    folder = Path(tempfile.gettempdir(), f"rover_harness_kernels_{user}")
    try:
        folder.mkdir(mode=0o700)
    except FileExistsError:
        status = folder.lstat()
        if stat.S_ISDIR(status.st_mode) and status.st_uid == user and not status.st_mode & 0o077:
            return str(folder)
    except OSError:
        pass
    else:
        _warn(f"compiled kernels are kept in {folder}")
        return str(folder)
    _warn("kernels are compiled anew at each start")
    return None


def _warn(problem: str) -> None:
    print(
        f"harness: {problem}: neither the installation nor the user's cache can be written "
        "(NUMBA_CACHE_DIR names another folder)",
        file=sys.stderr,
    )


def inlined(function: F) -> F:
    """Marks a helper of a kernel; it is compiled with the kernel that calls it, not by itself."""
    helper: F = numba.njit(nogil=True, error_model="numpy")(function)
    return helper


def entry(compiled: Callable[[int], None]) -> int:
    """Returns the address of a kernel void(int64); C calls it as int (result, error, argument)."""
    made: Any = compiled  # a dispatcher, of one signature
    if not IS_COMPILED:
        return _entry_of(compiled)
    (of,) = made.overloads.values()
    return int(of.library.get_pointer_to_function(of.fndesc.llvm_func_name))


@cache
def _entry_of(function: Callable[[int], None]) -> int:
    def call(_: object, __: object, argument: int) -> int:
        function(argument)
        return 0

    kinds = ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64
    _kept.append(made := ctypes.CFUNCTYPE(ctypes.c_int, *kinds)(call))
    return ctypes.cast(made, ctypes.c_void_p).value or 0


def symbol(name: str, address: int) -> Callable[[], int]:
    """Makes a function by which kernels get an address that is another one in each process.

    Args:
        name: Stands for it in compiled code, which can so be kept; one of its own among all symbols.
        address: In this process.
    """
    llvm.add_symbol(name, address)

    def typed(_: object) -> tuple[object, object]:
        def generate(_: object, builder: Any, *__: object) -> object:  # noqa: ANN401 - numba's
            anything = cgutils.ir.FunctionType(cgutils.ir.VoidType(), [])
            place = cgutils.get_or_insert_function(builder.module, anything, name)
            return builder.ptrtoint(place, cgutils.intp_t)

        return numba.types.intp(), generate

    made: Callable[[], int] = numba.extending.intrinsic(typed)
    return made


def native(*kinds: type, answers: bool = False) -> Callable[[int, Sequence[int]], Any]:
    """Makes a function (address, tuple of arguments) by which kernels call a C function.

    Args:
        kinds: Of the function's arguments: ctypes.c_void_p or c_int.
        answers: Whether it returns a c_int, or else nothing.
    """
    if not IS_COMPILED:
        returned = ctypes.c_int if answers else None
        made_of = ctypes.CFUNCTYPE(returned, *kinds)
        return lambda address, args: made_of(int(address))(*map(int, args))

    def typed(_: object, address: object, args: object) -> tuple[object, object]:
        def generate(context: Any, builder: Any, _: object, given: Any) -> object:  # noqa: ANN401
            integer, pointer = cgutils.ir.IntType(32), cgutils.voidptr_t
            returned = integer if answers else cgutils.ir.VoidType()
            passed = [integer if kind is ctypes.c_int else pointer for kind in kinds]
            function = cgutils.ir.FunctionType(returned, passed).as_pointer()
            values = zip(cgutils.unpack_tuple(builder, given[1]), passed, strict=True)
            answer = builder.call(
                builder.inttoptr(given[0], function),
                [
                    builder.trunc(value, kind) if kind is integer else builder.inttoptr(value, kind)
                    for value, kind in values
                ],
            )
            return answer if answers else context.get_dummy_value()

        return (numba.types.int32 if answers else numba.types.void)(address, args), generate

    made: Callable[[int, Sequence[int]], Any] = numba.extending.intrinsic(typed)
    return made


# Calls a kernel by its `entry`, with the addresses of a result and an error, and what it takes.
run_entry = native(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
