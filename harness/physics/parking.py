"""What keeps a rover where it stands while all its wheels are commanded to stand still.

MuJoCo's friction is regularised: it yields at a speed that grows with the load, and so does a wheel
whose servo has no integral action; a rover would creep down every slope. While it is parked, friction
is stiffer and the motors' torque holds the wheels like dry friction in their bearings. What drives is
as the model says, for both would cost it: stiff friction 4 to 5 % of a step's time, dry friction speed.
"""

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.scene import motors_of

PARKED_IMPRATIO = 30.0  # stiffness of friction over that of the contact's normal direction
LOCKED = 10.0  # times the motor's torque, that a stuck wheel resists: nor do motor and ground move it
NEARLY_RIGID = (0.9999, 0.9999, 0.001, 0.5, 2.0)  # solimp of the held bearings: they yield by 1e-4


class ParkingHold:
    """Switches a rover between driving and parked.

    The stiffness of friction is the model's, for all contacts: as long as one of several rovers is
    parked, it is that of a parked one.

    Args:
        model: Freshly compiled; is changed in place.
        joints: Names of the wheel joints; each has a motor.
        parked: The first wheels of the model's parked rovers, shared by all of them, who are made before
            one of them holds.

    Attributes:
        held: Whether the rover is parked.
    """

    def __init__(self, model: mujoco.MjModel, joints: tuple[str, ...], parked: set[str]) -> None:
        self._model, self._name = model, joints[0]
        # Not the rovers themselves: in a circle their model would outlive them until it is looked for.
        self._all_parked = parked
        self._dofs = np.array([int(model.joint(name).dofadr[0]) for name in joints])
        own = model.dof_frictionloss[self._dofs]
        self._driving = (model.opt.impratio, own, model.dof_solimp[self._dofs])
        parked_impratio = max(PARKED_IMPRATIO, model.opt.impratio)
        self._parked = (parked_impratio, own + _holding_torque(model, joints), np.array(NEARLY_RIGID))
        self.held, self._stuck = False, np.zeros(len(joints))
        self._strongest, self._joints = own + _holding_torque(model, joints), joints

    def block(self, stuck: frozenset[str]) -> None:
        """Keeps some wheels from turning, by the names of their joints, and lets go of all others."""
        blocked = np.array([name in stuck for name in self._joints])
        self._stuck = np.where(blocked, LOCKED * self._strongest, 0.0)
        self._take_hold()

    def hold(self, holds: bool) -> None:
        """Parks the rover, or lets it drive."""
        if holds != self.held:
            self.held = holds
            self._all_parked ^= {self._name}
            self._model.opt.impratio = (self._parked if self._all_parked else self._driving)[0]
            self._take_hold()

    def _take_hold(self) -> None:
        _, friction, solimp = self._parked if self.held else self._driving
        self._model.dof_frictionloss[self._dofs] = friction + self._stuck
        rigid = (self._stuck > 0.0)[:, None]
        self._model.dof_solimp[self._dofs] = np.where(rigid, NEARLY_RIGID, solimp)


def _holding_torque(model: mujoco.MjModel, joints: tuple[str, ...]) -> NDArray[np.float64]:
    """The largest torque of each motor [N m]; without a limit, the rover's weight on a lever of 1 m."""
    motors = motors_of(model, joints)
    weight = float(model.body_mass.sum() * np.linalg.norm(model.opt.gravity))
    limited = model.actuator_forcelimited[motors].astype(bool)
    return np.where(limited, model.actuator_forcerange[motors, 1], weight)
