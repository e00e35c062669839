"""A bed of soil under the wheels of a MuJoCo model: forces in each step, and the ruts that stay.

MuJoCo calls a compiled function in each of its steps, after positions and velocities and before forces,
so that plain steps and several ticks in one call work alike. It is one for the whole process and finds
the bed of a state by the state's address.
"""

import weakref
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numba
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import callback, symbol
from harness.base.errors import UsageError
from harness.base.passing import filled, pointer
from harness.soil.press_kernel import BED, FELT, MUJOCO, NUMBERS, OWN, press_bed
from harness.soil.soils import SOIL_CONTACT, Soil
from harness.soil.stability import check_steps
from harness.soil.wheel_force import STATE, UNPLACED, SoilWheel

MOST_BEDS = 256  # in a process at a time
DC_GAIN = 6  # where a DC motor's parameters have the gain of its controller of speed
SEEN = 4.0  # [m] around a camera in which ruts are shown

Doubles = NDArray[np.float64]
Patch = tuple[int, int, NDArray[np.float32]]  # first row and column, heights [m]


@dataclass(frozen=True)
class Ground:
    """A grid of heights that MuJoCo has too."""

    heights: Doubles  # without ruts [m], shape (rows, columns)
    corner: tuple[float, float]  # x, y of the first one [m]
    cell: float  # distance of two [m]
    field: NDArray[np.float32]  # MuJoCo's, a view of the same shape, of 0 to 1
    base: float  # height of its 0 [m]
    relief: float  # height of its 1 above that [m]
    solid: Doubles  # heights that what is no wheel meets [m]
    solid_cell: float  # distance of two of those [m]
    patches: NDArray[np.uint8]  # which soil lies at each of the solid heights, uint8 of their shape


class Bed:
    """Soil under all wheels of a model.

    Args:
        soils: What the ground is of, patch by patch.
        ground: Its heights.
        wheels: In the model.
        model: MuJoCo's.
        data: Its state.

    Attributes:
        surface: Heights of the ground with its ruts [m], shape (rows, columns); changes in each step.
        states: What the wheels remember, a row of each; kept and put back with the state of a rover.
        leaves_ruts: Whether any of its soils stays where it was pressed to.
        felt: Of each wheel: sinkage [m], forces of the soil ahead, left and up [N], speed of the rim, of
            the hub ahead and left [m/s], depth of the rut ahead [m]; shape (n, 8).

    Raises:
        UsageError: A wheel is narrower than a cell, or the soil is too stiff for the timestep.
    """

    def __init__(
        self,
        soils: Sequence[Soil],
        ground: Ground,
        wheels: Sequence[SoilWheel],
        model: mujoco.MjModel,
        data: mujoco.MjData,
    ) -> None:
        self.wheels, self._ground = tuple(wheels), ground
        self.leaves_ruts = any(soil.leaves_ruts for soil in soils)
        gravity = -float(model.opt.gravity[2])
        widest = max(wheel.width for wheel in wheels)
        self._numbers = np.array([soil.numbers(widest, gravity) for soil in soils])
        for soil, numbers in zip(soils, self._numbers, strict=True):
            check_steps(soil, numbers, self.wheels, gravity, float(model.opt.timestep))
        self._virgin, self.surface = ground.heights.copy(), ground.heights.copy()
        self._fresh = ground.field.copy()
        self.states = np.zeros((len(wheels), STATE))
        self.felt = np.zeros((len(wheels), FELT))
        sizes = [(w.radius, w.width, w.grousers, 1.0 if w.to_left else -1.0) for w in wheels]
        self._sizes = np.array(sizes)
        self._bodies = np.array([(w.body, w.joint, w.root) for w in wheels], np.int64)
        spins = [_spin(model, wheel) for wheel in wheels]
        self._spins = np.array([spin[:3] for spin in spins], np.int64)
        self._inertias = np.array([spin[3:] for spin in spins])
        self._held = model, data  # their memory is written to for as long as the bed is registered
        self._passed = self._to_pass(model, data)
        _register(data, self._passed, self)

    @property
    def lift(self) -> Doubles:
        """Force of the soil on each wheel upwards [N], shape (n,)."""
        return np.asarray(self.felt[:, 3])

    def wheels_of(self, root: int) -> slice:
        """Returns the rows of a rover's wheels, by its root body."""
        rows = np.flatnonzero(self._bodies[:, 2] == root)
        return slice(int(rows[0]), int(rows[-1]) + 1)

    def around(self, x: float, y: float) -> Patch | None:
        """Returns heights within SEEN of a place; None where nothing leaves ruts."""
        if not self.leaves_ruts:
            return None
        (x0, y0), cell = self._ground.corner, self._ground.cell
        row, column = (max(int((at - SEEN) / cell), 0) for at in (y - y0, x - x0))
        across = int(2.0 * SEEN / cell)
        heights = self.surface[row : row + across, column : column + across]
        return row, column, heights.astype(np.float32)

    def lay(self, other: "Bed") -> None:
        """Takes over the ruts of another bed of the same ground."""
        for mine, others in zip(self._grids(), other._grids(), strict=True):  # noqa: SLF001 - its own kind
            mine[:] = others

    def _grids(self) -> tuple[NDArray[Any], ...]:
        return self._virgin, self.surface, self._ground.field

    def smooth(self) -> None:
        """Makes the ground as it was without ruts; what the wheels remember stays."""
        self._virgin[:] = self.surface[:] = self._ground.heights
        self._ground.field[:] = self._fresh
        self.states[:, UNPLACED] = 0.0

    def _to_pass(self, model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.void]:
        """What the kernel is passed, with the arrays whose addresses that holds kept alive."""
        ground, near = self._ground, np.flatnonzero(model.geom_conaffinity & SOIL_CONTACT)
        self._near = near, model.geom_aabb[near].copy()
        own = [self._numbers, self._sizes, self._bodies, self._spins, self._inertias]
        own += [*self._grids(), self.states, self.felt, *self._near, ground.solid, ground.patches]
        arrays = dict(zip(OWN, own, strict=True))
        for name in MUJOCO:
            arrays[name] = getattr(data if hasattr(data, name) else model, name)
        numbers = (*ground.corner, ground.cell, ground.base, ground.relief, model.opt.timestep)
        return filled(BED, arrays, dict(zip(NUMBERS, (*numbers, ground.solid_cell), strict=True)))


def _spin(model: mujoco.MjModel, wheel: SoilWheel) -> tuple[float, ...]:
    """What turns a wheel: a row of the kernel's `spins`, then one of its `inertias`."""
    first = int(model.jnt_dofadr[wheel.joint])
    # Beside the joint that turns it a wheel may have one for the play of its gear.
    last = int(model.body_dofadr[wheel.body] + model.body_dofnum[wheel.body]) - 1
    inertias = *model.dof_armature[[first, last]].tolist(), float(model.dof_M0[first])
    for servo in np.flatnonzero(model.actuator_trnid[:, 0] == wheel.joint).tolist():
        if model.actuator_forcelimited[servo] and model.actuator_gear[servo, 0] == 1.0:
            is_dc = model.actuator_gaintype[servo] == mujoco.mjtGain.mjGAIN_DCMOTOR
            gain = float(model.actuator_gainprm[servo, DC_GAIN if is_dc else 0])
            if is_dc or gain == -model.actuator_biasprm[servo, 2]:
                return first, last, servo, *inertias, gain
    return first, last, -1, *inertias, 0.0


_table = np.zeros((MOST_BEDS + 1, 2), np.int64)  # the state's address, that of the bed's arrays
_table_address = symbol("rover_harness_beds", _table.ctypes.data)


def _register(data: mujoco.MjData, passed: NDArray[np.void], bed: Bed) -> None:
    """Lets MuJoCo press the wheels of a bed whenever it steps that state, as long as the bed lives."""
    free = np.flatnonzero(_table[:MOST_BEDS, 0] == 0)
    if not free.size:
        raise UsageError(f"more than {MOST_BEDS} simulations with soil in a process; use several")
    row = int(free[0])
    _table[row] = data._address, passed.ctypes.data  # noqa: SLF001 - MuJoCo offers no other name
    mujoco.set_mjcb_control(_press.ctypes)  # type: ignore[attr-defined]  # numba has no types
    weakref.finalize(bed, _table[row].fill, 0)


@callback("void(int64, int64)")
def _press(_: int, state: int) -> None:
    """Is called by MuJoCo in each step, with the addresses of a model and its state."""
    beds = numba.carray(pointer(_table_address()), (MOST_BEDS, 2), np.int64)
    for row in range(MOST_BEDS):
        if beds[row, 0] == state:
            press_bed(beds[row, 1])
            return
