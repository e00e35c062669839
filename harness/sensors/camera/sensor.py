"""A colour camera: the state that its image is drawn from, which is drawn only where somebody looks."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from harness.robots import RoverSpec
from harness.robots.sections import FrameRow
from harness.samples import Quaternion, Vector3
from harness.sensors.camera.lens import LENSES, Lens
from harness.sensors.depth import OPTICAL_RPY, optical_frame
from harness.sensors.optional import OptionalSensor, SensorOptions

Pixels = Annotated[int, Field(ge=8, le=4096)]  # along a side
VISIBLE_STATE = 1 << 1 | 1 << 10 | 1 << 11  # of mjtState: QPOS, MOCAP_POS, MOCAP_QUAT
MOUNTS = ("camera_link", "camera_frame")  # of rovers that have a place for a camera, x ahead


@dataclass(frozen=True, slots=True)
class CameraState:
    """What an image is drawn from."""

    stamp_ns: int
    sensor: str
    position: Vector3  # of the optical frame in the world [m]
    orientation: Quaternion  # of that frame, (x, y, z, w): z ahead, y down
    state: NDArray[np.float64]  # of the whole scene, as MuJoCo has it
    # its ground nearby, as harness.soil.bed.Bed.around; None on ground that keeps no ruts
    ground: tuple[int, int, NDArray[np.float32]] | None = None


class CameraOptions(SensorOptions):
    """Options of a camera.

    Without a parent it is the rover's own camera if that has this optical frame, or hangs on one of
    MOUNTS, or is where the lidar is.

    Attributes:
        frame: Its optical frame (x right, y down, z ahead); NAME_optical_frame if left out.
        preset: `roboterrain` and `fisheye` are RoboTerrain's.
        lens: `pinhole`, or `fisheye`, which is equidistant: its angles are evenly spaced.
        width: Pixels in a row, 8 to 4096.
        height: Rows, 8 to 4096.
        fov: Horizontal field of view [rad].
        noise: Standard deviation of a pixel over the full scale; RoboTerrain's cameras have 0.007.
    """

    presets: ClassVar[Mapping[str, Mapping[str, object]]] = {
        "roboterrain": {},  # the defaults
        "fisheye": {"lens": "fisheye", "width": 1600, "height": 600, "fov": 2.8},
        "small": {"width": 160, "height": 120},
        "small_fisheye": {"lens": "fisheye", "width": 320, "height": 120, "fov": 2.8},
    }

    preset: str = "roboterrain"
    lens: Literal["pinhole", "fisheye"] = "pinhole"
    width: Pixels = 640
    height: Pixels = 480
    fov: Annotated[float, Field(gt=0.0)] = 1.1
    noise: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0

    @property
    def frame_id(self) -> str:
        """The frame of its messages."""
        return self.frame or optical_frame(self.name)

    def frames(self, rover: RoverSpec) -> tuple[FrameRow, ...]:
        """Returns the frames that it adds to those of a rover: mount and optical frame."""
        known = [row.child for row in rover.frames]
        if not self.parent and self.frame_id in known:
            return ()
        link = f"{self.name}_link"
        above = (name for name in MOUNTS if name in known and name != link)
        mounted = self.but(parent=self.parent or next(above, ""))
        optical = FrameRow(parent=link, child=self.frame_id, rpy=OPTICAL_RPY)
        return (*mounted.mount(rover, link), optical)

    def lens_of(self) -> Lens:
        """Returns its lens."""
        return LENSES[self.lens](self.width, self.height, self.fov)

    @model_validator(mode="after")
    def _check_fov(self) -> Self:
        widest = LENSES[self.lens].widest
        if self.fov > widest:
            most = f"give more than 0 and at most {math.floor(100 * widest) / 100:g}"
            raise ValueError(f"fov {self.fov:g} rad of a {self.lens} camera is not valid; {most}")
        return self


class CameraSensor(OptionalSensor[CameraOptions]):
    """The camera; it draws nothing itself."""

    def read(self) -> CameraState:
        """Returns what an image of now is drawn from."""
        import mujoco  # noqa: PLC0415 - not to publish

        simulation, pose, turned = self._simulation, self.pose(), np.empty(4)
        state = np.empty(mujoco.mj_stateSize(simulation.model, VISIBLE_STATE))
        mujoco.mj_getState(simulation.model, simulation.data, state, VISIBLE_STATE)
        mujoco.mju_mat2Quat(turned, pose[1:].ravel())
        w, x, y, z = turned.tolist()
        at, bed = tuple(pose[0].tolist()), simulation.physics.bed
        ground = None if bed is None else bed.around(*at[:2])
        return CameraState(simulation.time_ns, self.name, at, (x, y, z, w), state, ground)
