"""A colour camera: the state that its image is drawn from, which is drawn only where somebody looks."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, find_named
from harness.samples import Quaternion, Vector3, plain_value
from harness.sensors.base import Sensor
from harness.sensors.camera.lens import LENSES, Lens

if TYPE_CHECKING:  # the table of sensors does without MuJoCo
    from harness.physics.simulation import Simulation

FEWEST_PIXELS, MOST_PIXELS = 8, 4096  # along a side
VISIBLE_STATE = 1 << 1 | 1 << 10 | 1 << 11  # of mjtState: QPOS, MOCAP_POS, MOCAP_QUAT
MOST_NOISE = 0.5


@plain_value
class CameraState:
    """What an image is drawn from.

    Attributes:
        position: Of the optical frame in the world [m].
        orientation: Of the optical frame in the world, (x, y, z, w): x right, y down, z ahead.
        state: Of the whole scene, as MuJoCo has it.
    """

    stamp_ns: int
    position: Vector3
    orientation: Quaternion
    state: NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class CameraOptions:
    """Of a camera.

    Attributes:
        lens: One of LENSES.
        width: Of the image [pixels]; likewise `height`.
        fov: Horizontal field of view [rad].
        noise: Standard deviation of a pixel over the full scale; RoboTerrain's cameras have 0.007.
    """

    lens: str = "pinhole"
    width: int = 640
    height: int = 480
    fov: float = 1.1
    noise: float = 0.0

    def lens_of(self) -> Lens:
        """Returns its lens."""
        return LENSES[self.lens](self.width, self.height, self.fov)

    def check(self) -> None:
        """Checks the values.

        Raises:
            UsageError: One is not valid; the message names those that are.
        """
        widest = find_named("lens", self.lens, LENSES).widest
        for name, pixels in (("width", self.width), ("height", self.height)):
            if not FEWEST_PIXELS <= pixels <= MOST_PIXELS:
                raise UsageError(
                    f"a camera of {name} {pixels} is not valid; give {FEWEST_PIXELS} to {MOST_PIXELS} pixels"
                )
        if not 0.0 < self.fov <= widest:
            raise UsageError(
                f"fov {self.fov:g} rad of a {self.lens} camera is not valid; "
                f"give more than 0 and at most {math.floor(100 * widest) / 100:g}"
            )
        if not 0.0 <= self.noise <= MOST_NOISE:
            raise UsageError(f"noise {self.noise:g} of a camera is not valid; give 0 to {MOST_NOISE:g}")
