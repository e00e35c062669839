"""One rover's part of the state of a world: views into MuJoCo's, to read, to keep and to put back."""

from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.actuators import Drag
from harness.physics.contacts import RoverContacts
from harness.physics.parking import ParkingHold
from harness.physics.scene import Scene, motors_of

if TYPE_CHECKING:
    from harness.soil.bed import Bed

AT_REST_SPEED = 2e-3  # [m/s] and [rad/s]: below it a rover counts as settled

State = list[NDArray[np.float64]]


class Rover:
    """What of MuJoCo's state is one rover's, its brake and what it touches.

    Args:
        scene: The rover in its world.
        data: The state of all rovers there.
        contacts: What it touches.
        parked: As ParkingHold has it.
        bed: The soil under all of them; None on rigid ground.

    Attributes:
        scene: The rover in its world.
        qpos_at: Where its pose stands in MuJoCo's positions.
        pose: Position [m] and w, x, y, z of its model frame, a view into MuJoCo's.
        twist: Linear velocity [m/s] in the world, angular velocity [rad/s] in the model frame, a view.
        contacts: What it touches in the tick that is shown.
        now: Its pose in the tick that is shown, as `pose`.
        parking: Its brake.
        drag: What the ground resists of its motion.
        motors: The actuators that are commanded, in the order of the rover's `motors`; the first
            `driven` of them drive.
        ahead: To them in the ticks that are simulated next, shape (SPAN, motors).
        parked: Whether it is parked in each of these ticks.
        put_back_at: Step at which it was put elsewhere last; -1 for never.
    """

    ahead: NDArray[np.float64]

    def __init__(
        self,
        scene: Scene,
        data: mujoco.MjData,
        contacts: RoverContacts,
        parked: set[str],
        bed: "Bed | None" = None,
    ) -> None:
        self.scene, self.contacts = scene, contacts
        model, self._geoms = scene.model, scene.geoms()
        self.parking = ParkingHold(model, scene.all_own(scene.rover.drive.driven), parked)
        self.drag = Drag(model, scene.rover, scene.root)
        self.motors = np.array(motors_of(model, scene.all_own(scene.rover.motors)))
        self.driven = len(scene.rover.drive.driven)
        self.parked: list[bool] = []
        self.put_back_at = -1
        joints = np.flatnonzero(model.body_rootid[model.jnt_bodyid] == scene.root)
        dofs = np.flatnonzero(model.body_rootid[model.dof_bodyid] == scene.root)
        motors = np.flatnonzero(np.isin(model.actuator_trnid[:, 0], joints))
        self.qpos_at = at = scene.qpos_at
        moving = slice(int(dofs[0]), int(dofs[-1]) + 1)
        self.pose, self.twist = data.qpos[at : at + 7], data.qvel[moving][:6]
        self.now: list[float] = self.pose.tolist()
        after = model.jnt_qposadr[joints[-1] + 1] if joints[-1] + 1 < model.njnt else model.nq
        # All that its next step depends on, warm start included: it goes on bit for bit.
        self._state = [data.qpos[at:after], data.qvel[moving], data.qacc_warmstart[moving]]
        self._lift = None if bed is None else bed.lift[bed.wheels_of(scene.root)]
        if bed is not None:
            own = slice(self._geoms[0], self._geoms[-1] + 1)
            self._state += [bed.states[bed.wheels_of(scene.root)], model.geom_conaffinity[own]]
            self._state.append(model.dof_armature[moving])
        if motors.size:
            first, last = int(motors[0]), int(motors[-1])
            self._state.append(data.ctrl[first : last + 1])
            acts = model.actuator_actadr[first : last + 1]
            if (acts := acts[acts >= 0]).size:
                self._state.append(data.act[int(acts[0]) : int(acts[-1]) + model.actuator_actnum[last]])

    def command(self, commands: NDArray[np.float64]) -> None:
        """Takes commands to the motors for the next ticks, shape (ticks, motors)."""
        self.ahead[: len(commands)] = commands
        self.parked = [not any(speeds) for speeds in commands[:, : self.driven].tolist()]

    @property
    def velocities(self) -> NDArray[np.float64]:
        """All its velocities, a view into MuJoCo's."""
        velocities: NDArray[np.float64] = self._state[1]
        return velocities

    def rests(self, data: mujoco.MjData) -> bool:
        """Returns whether it stands on something."""
        still = np.abs(self.velocities).max() < AT_REST_SPEED
        if not still:
            return False
        on_soil = self._lift is not None and bool(self._lift.any())
        return on_soil or bool(np.isin(data.contact.geom, self._geoms).any())

    def state(self) -> State:
        """Returns a copy of its state."""
        return [part.copy() for part in self._state]

    def restore(self, state: State) -> None:
        """Takes a state that it was in."""
        for part, values in zip(self._state, state, strict=True):
            part[:] = values
