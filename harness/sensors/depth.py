"""A depth camera: an image of depths along its optical axis, exact, without a renderer."""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from harness.robots import RoverSpec
from harness.robots.sections import Angles, FrameRow
from harness.sensors.camera.lens import Pinhole
from harness.sensors.ranging import RangeOptions
from harness.spec.value import Length, NotNegative

OPTICAL_RPY = (-math.pi / 2, 0.0, -math.pi / 2)  # REP-103: z ahead, x right, y down


def optical_frame(mount: str) -> str:
    """Returns the name of the optical frame below a camera's mount: eye_optical_frame of eye_link."""
    return f"{mount.removesuffix('_link').removesuffix('_frame')}_optical_frame"


class DepthOptions(RangeOptions):
    """A pinhole camera with square pixels and its optical axis in the middle of the image.

    Its messages are in the optical frame (z ahead, x right, y down) below its mount `frame`, which is
    NAME_optical_frame of NAME_link.

    Attributes:
        preset: Name of values of the others.
        width: Pixels in a row.
        height: Rows.
        fov: Horizontal field of view, from edge to edge of the image [rad].
        cloud: Whether a PointCloud2 of the image is published too.
    """

    # RoboTerrain's leo_depth: 640 x 480, 1.047 rad, 0.05-10 m, 30 Hz, which are no whole number of the
    # clock's ticks of 10 ms.
    presets: ClassVar[Mapping[str, Mapping[str, object]]] = {
        "small": {},  # the defaults
        "roboterrain": {"width": 640, "height": 480, "rate": 25},
    }

    preset: str = "small"
    rpy: Angles = (0.0, 0.35, 0.0)  # a little down; RoboTerrain's depth camera is tilted as much
    width: Annotated[int, Field(ge=1)] = 160
    height: Annotated[int, Field(ge=1)] = 120
    fov: Annotated[float, Field(gt=0.0, lt=math.pi)] = 1.047
    range_min: NotNegative = 0.05
    range_max: Length = 10.0
    cloud: bool = False
    lost: ClassVar[float] = math.nan  # REP-118: nothing was measured there

    @property
    def frame_id(self) -> str:
        """Name of the optical frame."""
        return optical_frame(super().frame_id)

    @property
    def rays(self) -> int:
        """Number of pixels."""
        return self.width * self.height

    def frames(self, rover: RoverSpec) -> tuple[FrameRow, ...]:
        """Returns its mount and its optical frame, as far as the rover does not have them."""
        frame = super().frame_id
        mount = self.mount(rover, frame)
        if not mount and any(row.child == self.frame_id for row in rover.frames):
            return ()
        return (*mount, FrameRow(parent=frame, child=self.frame_id, rpy=OPTICAL_RPY))

    def directions(self) -> NDArray[np.float64]:
        """Returns vectors of depth 1 in the optical frame, row by row from the top, shape (rays, 3)."""
        right, down = Pinhole(self.width, self.height, self.fov).offsets()
        return np.column_stack([right.ravel(), down.ravel(), np.ones(self.rays)])
