"""What ends a simulation: a state that diverged, or a rover at the edge of the map."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from harness.base.errors import Diverged, RunFailed
from harness.base.sim_time import NANOSECONDS
from harness.physics.rover import Rover
from harness.world.heightfield import EDGE_MARGIN

LACKING = {
    mujoco.mjtWarning.mjWARN_INERTIA: (
        "the inertia of a body is too small to solve for; enlarge it, or try a smaller --timestep"
    ),
    **dict.fromkeys(
        (mujoco.mjtWarning.mjWARN_CONTACTFULL, mujoco.mjtWarning.mjWARN_CNSTRFULL),
        'its memory holds no more contacts; let a model ask for more: <size memory="200M"/>',
    ),
}
DIVERGED = {
    mujoco.mjtWarning.mjWARN_BADQPOS: "position",
    mujoco.mjtWarning.mjWARN_BADQVEL: "velocity",
    mujoco.mjtWarning.mjWARN_BADQACC: "acceleration",
    mujoco.mjtWarning.mjWARN_BADCTRL: "wheel command",
}


def check_place(rovers: Sequence[Rover], time_ns: int) -> None:
    """Checks where rovers are.

    Args:
        rovers: All of a world.
        time_ns: Simulation time.

    Raises:
        RunFailed: One of them reached the edge of the map.
    """
    for rover in rovers:
        x, y = rover.pose[:2].tolist()
        if not rover.scene.world.ground.contains(x, y, EDGE_MARGIN):
            raise RunFailed(
                f"{rover.scene.label} reached the edge of the map at t = {_seconds(time_ns)} "
                f"(x = {x:.2f} m, y = {y:.2f} m)"
            )


def check_health(data: mujoco.MjData, rovers: Sequence[Rover], time_ns: int) -> None:
    """Checks MuJoCo's warnings, each of which says that the state is not to be trusted any more.

    Args:
        data: The state that they are of.
        rovers: All of a world.
        time_ns: Simulation time.

    Raises:
        Diverged: There are some.
    """
    for warning, quantity in DIVERGED.items():
        if data.warning[warning].number:
            fastest = max(map(_violence, rovers))
            wild = [rover for rover in rovers if _violence(rover) == fastest]
            whose = " or ".join(filter(None, (rover.scene.name for rover in wild)))
            pose, twist = wild[0].pose[:3], wild[0].twist[:3]  # what is no number soon spreads
            raise Diverged(
                f"{whose and whose + ': '}the simulation diverged at t = {_seconds(time_ns)} "
                f"(NaN, infinite or huge {quantity}); position {pose.round(3).tolist()} m, "
                f"velocity {twist.round(3).tolist()} m/s; try a smaller --timestep"
            )
    for warning, lack in LACKING.items():
        if data.warning[warning].number:
            raise Diverged(f"the simulation went wrong at t = {_seconds(time_ns)}: {lack}")


def _seconds(time_ns: int) -> str:
    return f"{time_ns / NANOSECONDS:.2f} s"


def _violence(rover: Rover) -> float:
    """How fast anything of a rover moves; infinite where that is no number."""
    fastest = float(np.abs(rover.velocities).max())
    return fastest if math.isfinite(fastest) else math.inf
