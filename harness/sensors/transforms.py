"""What is published of a rover's frames: the fixed ones once, the moving ones before a tick's samples.

odom -> base comes with every tick that has samples, so that each of them can be transformed at its
stamp as it arrives; joints 20 times a second, as often as robot_state_publisher does by default
(its publish_frequency).
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, cast

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import TICK_NS, period_ticks
from harness.physics.simulation import Simulation
from harness.robots.frames.rover_frames import HINGE, RoverFrames, cleared
from harness.robots.frames.tree import FOOTPRINT, MAP, ODOM, Description, Edge
from harness.robots.frames.urdf import write_urdf
from harness.samples import Odometry, Quaternion, Source, Transforms, Vector3
from harness.sensors.base import EpisodeParts, Sensor
from harness.spec.ros import NONE, WHEELS, FrameOptions

if TYPE_CHECKING:
    from harness.sensors.odometry import WheelOdometry

JOINT_TICKS = period_ticks(20)

Values = NDArray[np.float64]


def describe(frames: RoverFrames, options: FrameOptions) -> Description:
    """Returns what is published of a rover before its first tick."""
    fixed = [frames.edge(link) for link in frames.links[1:] if link.joint < 0]
    moving = [(link.parent, link.name) for link in frames.moving]
    if all(link.name != FOOTPRINT for link in frames.links):
        fixed.append(Edge(frames.base, FOOTPRINT))  # RoboTerrain's pose is that of the model, from above
    if options.map_tf:
        fixed.insert(0, Edge(MAP, ODOM))
    if options.odom_tf != NONE:
        moving.insert(0, (ODOM, frames.base))
    return Description(tuple(fixed), tuple(moving), options.odom_tf != NONE, write_urdf(frames))


class TransformSensor(Sensor):
    """Where the rover is in odom, and its moving parts in their parents.

    Args:
        simulation: Of the rover.
        frames: The rover's.
        options: Who owns odom -> base.
        sensors: The episode's, which may be made later; asked for the wheel odometry and what is due.
        period_ticks: Clock ticks between two samples, at least.
    """

    def __init__(
        self,
        simulation: Simulation,
        frames: RoverFrames,
        options: FrameOptions,
        sensors: Mapping[Source, Sensor],
        period_ticks: int,
    ) -> None:
        super().__init__(simulation, period_ticks)
        self._options, self._sensors = options, sensors
        self._owns_odom = options.odom_tf != NONE
        self._joints = _Joints(simulation, frames) if frames.moving else None

    @classmethod
    def of(cls, parts: EpisodeParts, period_ticks: int) -> "TransformSensor | None":
        """Returns the transforms of an episode; None if nobody wants any."""
        frames, options = parts.frames, parts.frame_options
        if frames is None or options is None:
            return None
        return cls(parts.simulation, frames, options, parts.sensors, period_ticks)

    def due(self, tick: int) -> bool:
        """Returns whether the joints are due, or odom -> base for other samples."""
        if self._joints is not None and tick % JOINT_TICKS == 0:
            return True
        others = (sensor for sensor in self._sensors.values() if sensor is not self)
        return self._owns_odom and any(other.due(tick) for other in others)

    def read(self) -> Transforms:
        """Returns odom -> base unless somebody else owns it, and the joints when they are due."""
        none: tuple[tuple[float, ...], tuple[float, ...]] = (), ()
        translation, rotation = self._base() if self._owns_odom else none
        time_ns = self._simulation.time_ns
        if self._joints is not None and time_ns // TICK_NS % JOINT_TICKS == 0:
            moved, turned = self._joints.poses()
            translation, rotation = (*translation, *moved), (*rotation, *turned)
        return Transforms(time_ns, translation, rotation)

    def _base(self) -> tuple[Vector3, Quaternion]:
        """T_odom_base; wheel odometry as it stands now, also between two of its samples."""
        simulation = self._simulation
        if self._options.odom_tf_3d:
            return simulation.position, simulation.orientation
        if self._options.odom_tf == WHEELS:
            x, y, yaw = cast("WheelOdometry", self._sensors[Odometry]).pose()
        else:
            (x, y, _), yaw = simulation.position, simulation.yaw
        return (x, y, 0.0), (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))


class _Joints:
    """The poses that joints give to frames.

    A hinge turns a frame from the attitude q, at 0, to q cos(angle / 2) + (q * axis) sin(angle / 2); a
    slide moves its origin along the axis. Plain floats: six joints are too few for arrays to be faster.
    """

    def __init__(self, simulation: Simulation, frames: RoverFrames) -> None:
        links, model = frames.moving, frames.model
        self._qpos = simulation.data.qpos
        names = [model.joint(link.joint).name for link in links]
        self._address = np.array(
            [int(simulation.model.joint(simulation.scene.own(name)).qposadr[0]) for name in names]
        )
        hinges = [model.jnt_type[link.joint] == HINGE for link in links]
        edges = [frames.edge(link) for link in links]
        axes = [(edge.rotation, frames.axis(link)) for edge, link in zip(edges, links, strict=True)]
        self._frames = [
            (is_hinge, edge.translation, edge.rotation, _turned(*axis), _about(*axis))
            for is_hinge, edge, axis in zip(hinges, edges, axes, strict=True)
        ]

    def poses(self) -> tuple[list[float], list[float]]:
        """Returns translations and rotations of all frames, one after the other."""
        translation: list[float] = []
        rotation: list[float] = []
        positions = self._qpos[self._address].tolist()
        for position, frame in zip(positions, self._frames, strict=True):
            is_hinge, origin, at_zero, along, (a, b, c, d) = frame
            if is_hinge:
                cosine, sine = math.cos(position / 2), math.sin(position / 2)
                x, y, z, w = at_zero
                turned = cosine * x + sine * a, cosine * y + sine * b, cosine * z + sine * c
                translation += origin
                rotation += (*turned, cosine * w + sine * d)
            else:
                translation += [o + position * share for o, share in zip(origin, along, strict=True)]
                rotation += at_zero
        return translation, rotation


def _turned(rotation: Quaternion, axis: Values) -> list[float]:
    """An axis of the frame, at 0, in the parent's axes."""
    turned, (x, y, z, w) = np.empty(3), rotation
    mujoco.mju_rotVecQuat(turned, axis, np.array([w, x, y, z]))
    return cleared(turned)


def _about(rotation: Quaternion, axis: Values) -> list[float]:
    """The product q * axis of quaternions, as (x, y, z, w)."""
    product, (x, y, z, w) = np.empty(4), rotation
    mujoco.mju_mulQuat(product, np.array([w, x, y, z]), np.array([0.0, *axis]))
    w, x, y, z = cleared(product)
    return [x, y, z, w]
