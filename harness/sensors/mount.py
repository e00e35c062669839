"""Where an optional sensor is: its frame, fixed to a body of the scene."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:  # whoever only publishes does without MuJoCo
    import mujoco


@dataclass(frozen=True, eq=False)
class Mount:
    """A frame that is fixed to a body.

    Attributes:
        body: Index of the body.
        xyz: Origin of the frame in the body [m], shape (3,).
        axes: Rotation R_body_sensor, shape (3, 3).
    """

    body: int
    xyz: NDArray[np.float64]
    axes: NDArray[np.float64]

    def pose(self, data: "mujoco.MjData") -> NDArray[np.float64]:
        """Returns origin in the world [m] and below it the rotation R_world_sensor, shape (4, 3).

        The poses in `data` must be those of its qpos: after mj_step, call mj_kinematics first.
        """
        turn = data.xmat[self.body].reshape(3, 3)
        return np.vstack([data.xpos[self.body] + turn @ self.xyz, turn @ self.axes])
