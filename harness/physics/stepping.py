"""Steps of MuJoCo one after the other in one compiled call, which leaves the interpreter to others.

Between two steps nobody needs Python, unless something was touched: then the call ends, somebody looks
at the contacts, and the next call goes on. What the ends of the clock ticks in between looked like
is recorded.
"""

import ctypes
import sys
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numba
import numpy as np
from numba.core import cgutils
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel
from harness.base.sim_time import TICKS_PER_CONTROL

SPAN = TICKS_PER_CONTROL  # clock ticks that are simulated in one go, at most
LIBRARIES = {"win32": "mujoco.dll", "darwin": f"libmujoco.{mujoco.__version__}.dylib"}
RECORDED = ("qpos", "qvel", "qfrc_actuator")  # of MuJoCo's state at the end of a tick

Doubles = NDArray[np.float64]
Integers = NDArray[np.int64]


class Span:
    """Clock ticks that are simulated in one go: what is commanded before, what each was like after.

    Args:
        model: The compiled scene.
        data: Its state.
        motors: Controls that are commanded.

    Attributes:
        commands: To the motors in each tick, shape (SPAN, motors).
        warnings: MuJoCo's counters of them.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, motors: Integers) -> None:
        self.commands = np.zeros((SPAN, motors.size))
        self.warnings = data.warning.number  # a view: MuJoCo counts up in it
        self._addresses = _step_address(), model._address, data._address  # noqa: SLF001 - no other name
        self._control = data.ctrl, motors, self.commands
        self._felt = data.sensordata, np.zeros((SPAN, data.sensordata.size))
        self._state: tuple[Doubles, ...] = tuple(getattr(data, name) for name in RECORDED)
        self._record = tuple(np.zeros((SPAN, part.size)) for part in self._state)

    def advance(self, steps: tuple[int, int, int], touches: Integers) -> int:
        """Steps until something is touched, until a tick that ends with warnings, or to the end.

        Args:
            steps: Where to begin and to end, counted from the first tick's first step; steps of a tick.
            touches: Sensors that are not 0 when something is touched.

        Returns:
            Where it ended, counted as in `steps`.
        """
        watched = self.warnings, touches
        return advance(
            self._addresses, steps, self._control, watched, self._felt, self._state, self._record
        )

    def show(self, tick: int, sums: Doubles) -> None:
        """Sets what RECORDED names to what it was at the end of a tick, and the sums of its sensors."""
        for part, values in zip(self._state, self._record, strict=True):
            part[:] = values[tick]
        sums[:] = self._felt[1][tick]


@cache
def _step_address() -> int:
    """The address of MuJoCo's mj_step in this process."""
    name = LIBRARIES.get(sys.platform, f"libmujoco.so.{mujoco.__version__}")
    library = ctypes.CDLL(str(Path(mujoco.__file__).with_name(name)))
    return ctypes.cast(library.mj_step, ctypes.c_void_p).value or 0


def _in_python(address: int, model: int, data: int) -> None:
    ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(address)(model, data)


def _compiled(_: object, address: object, model: object, data: object) -> tuple[object, object]:
    """What numba makes of a call, for arguments of these types."""

    def generate(context: Any, builder: Any, _: object, args: Any) -> object:  # noqa: ANN401 - numba's
        kind = cgutils.ir.FunctionType(cgutils.ir.VoidType(), [cgutils.voidptr_t] * 2)
        called = builder.inttoptr(args[0], kind.as_pointer())
        builder.call(called, [builder.inttoptr(arg, cgutils.voidptr_t) for arg in args[1:]])
        return context.get_dummy_value()

    return numba.types.void(address, model, data), generate


_step = _in_python if numba.config.DISABLE_JIT else numba.extending.intrinsic(_compiled)


@inlined
def _begin_tick(control: tuple[Doubles, Integers, Doubles], tick: int) -> None:
    controls, motors, commands = control
    for place in range(motors.size):
        controls[motors[place]] = commands[tick, place]


@kernel(
    "int64(UniTuple(int64, 3), UniTuple(int64, 3), Tuple((float64[::1], int64[::1], float64[:,::1])),"
    "Tuple((int32[:], int64[::1])), Tuple((float64[::1], float64[:,::1])),"
    "UniTuple(float64[::1], 3), UniTuple(float64[:,::1], 3))"
)
def advance(
    addresses: tuple[int, int, int],
    steps: tuple[int, int, int],
    control: tuple[Doubles, Integers, Doubles],
    watched: tuple[NDArray[np.int32], Integers],
    felt: tuple[Doubles, Doubles],
    state: tuple[Doubles, ...],
    record: tuple[Doubles, ...],
) -> int:
    """Does what `Span.advance` says.

    Args:
        addresses: Of mj_step, of the model and of its data.
        steps: As there.
        control: The data's controls, those that are commanded, and to what, shape (ticks, motors).
        watched: The data's counters of warnings; of its sensors those that are not 0 at a touch.
        felt: The data's sensor values; where their sums over a tick's steps come, (ticks, sensors).
        state: What of the data is recorded.
        record: Where it comes as it is at the end of each tick, each (ticks, ...).
    """
    begin, end, per_tick = steps
    (warnings, touches), (sensors, sums) = watched, felt
    for step in range(begin, end):
        tick, within = step // per_tick, step % per_tick
        if within == 0:
            _begin_tick(control, tick)
            sums[tick] = 0.0
        _step(addresses[0], addresses[1], addresses[2])
        sums[tick] += sensors
        if within == per_tick - 1:
            for part in range(len(state)):
                record[part][tick] = state[part]
            if np.any(warnings):
                return step + 1
        for touch in touches:
            if sensors[touch]:
                return step + 1
    return end
