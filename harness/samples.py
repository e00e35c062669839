"""Sensor readings, the truth and what a tick of an episode carries: plain values, no ROS.

They flow from harness.sensors through harness.episode either into harness.ros.bridge (as topics) or
straight into rover_metrics (harness.episode.direct). Stamps are simulation time in nanoseconds; frames
and units follow REP-103: metres, radians, seconds, x forward, y left, z up; quaternions are
(x, y, z, w).
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
ContactKind = Literal["hazard", "rock", "scrape"]
LIDAR_RANGE_MAX = 10.0  # [m] of RoboTerrain's gpu_lidar; a hit beyond it is a miss

T = TypeVar("T")
S = TypeVar("S", bound="Sample")


class Sample(Protocol):
    """One reading of a sensor: a frozen dataclass with the simulation time of its stamp [ns]."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def stamp_ns(self) -> int:
        """Returns the stamp [ns]."""


Source = type[Sample] | str


def source(sample: Sample) -> Source:
    """Returns what read a sample: the name in `sensor` if a rover may carry several, else the type."""
    return getattr(sample, "sensor", type(sample))


@dataclass(frozen=True, slots=True)
class Twist:
    """A body-frame velocity: linear.x in m/s (forward) and angular.z in rad/s (left)."""

    linear: float = 0.0
    angular: float = 0.0


@dataclass(frozen=True, slots=True)
class Place:
    """A position [m] and heading [rad] in the world, seen from above."""

    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class LaserScan:
    """One lidar revolution in the lidar's frame; `ranges` is float32, beam 0 at -pi, REP-117 coded."""

    stamp_ns: int
    ranges: NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Imu:
    """Means over the sensor's window: specific force (gravity included) and rate, in imu frame."""

    stamp_ns: int
    orientation: Quaternion
    angular_velocity: Vector3
    linear_acceleration: Vector3


@dataclass(frozen=True, slots=True)
class Pose:
    """Pose of the model frame in the world; `empty` stands for an array without it (a fault)."""

    stamp_ns: int
    position: Vector3
    orientation: Quaternion
    empty: bool = False


@dataclass(frozen=True, slots=True)
class Odometry:
    """Planar pose in the odom frame and body-frame twist, as wheel encoders tell it."""

    stamp_ns: int
    x: float
    y: float
    yaw: float
    twist: Twist


@dataclass(frozen=True, slots=True)
class GroundTruth:
    """The true planar pose and the true body-frame velocity."""

    stamp_ns: int
    x: float
    y: float
    yaw: float
    linear_velocity: Vector3
    angular_velocity: Vector3


@dataclass(frozen=True, slots=True)
class JointStates:
    """Position [rad], velocity [rad/s] and effort [N m] of the joints named by the rover's spec."""

    stamp_ns: int
    position: tuple[float, ...]
    velocity: tuple[float, ...]
    effort: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class GoalPose:
    """A goal for who drives over topics: the next way point of a route, in the world."""

    stamp_ns: int
    position: Vector3
    orientation: Quaternion


@dataclass(frozen=True, slots=True)
class ActorPoses:
    """Middles [m] and attitudes of the people in the world, in the order of its actors."""

    stamp_ns: int
    position: tuple[Vector3, ...]
    orientation: tuple[Quaternion, ...]


@dataclass(frozen=True, slots=True)
class Transforms:
    """Poses of frames in their parents, in the order of harness.robots.frames.tree.Description."""

    stamp_ns: int
    translation: tuple[float, ...]  # x, y, z of each frame [m], one after the other
    rotation: tuple[float, ...]  # quaternion (x, y, z, w) of each frame, one after the other


@dataclass(frozen=True, slots=True)
class SoilState:
    """What soil does to each wheel now, in the order of RoverSpec.wheel_joints."""

    # depth of the lowest point below the ground without ruts [m], 0 in the air
    sinkage: tuple[float, ...]
    # between the wheel's plane and its way over the ground, positive to the left [rad]
    slip_angle: tuple[float, ...]
    # force of the soil along the wheel's heading, drawbar pull where positive [N]
    pull: tuple[float, ...]
    side_force: tuple[float, ...]  # force of the soil to the left of the wheel [N]
    stuck: bool  # whether the wheels have turned for a second without getting on
    # x, y of the wheel in the world and how deep its rut is there [m]; not published
    ruts: tuple[Vector3, ...] = ()

    @property
    def values(self) -> tuple[float, ...]:
        """Returns the values that are published, in their order."""
        return (*self.sinkage, *self.slip_angle, *self.pull, *self.side_force, self.stuck)


@dataclass(frozen=True, slots=True)
class TruthState:
    """What only the simulator knows, now and in the 50 ms since the last one; faults leave it alone."""

    stamp_ns: int
    hazard_contact: bool  # whether any part touched a hazard since the last one
    rock_contact: bool  # whether any part touched a rock since the last one
    scrape: bool  # whether anything but a wheel touched the ground since the last one
    # largest normal force at one contact point with a hazard since the last one [N]
    contact_force: float
    speed: float  # true forward speed of the model frame, negative backwards [m/s]
    path_length: float  # of the model frame since the start, in three dimensions [m]
    # slip ratio of each wheel in the order of RoverSpec.wheel_joints, -1..1; positive when it
    # turns faster than it moves, 0 while it stands (harness.physics.truth.wheels)
    slip: tuple[float, ...]
    # of the terrain under the wheels [m]: the root of the mean, over the windows of 0.3 m around
    # the wheels, of the squared height above the mean of the 0.3 m around
    roughness: float
    soil: SoilState | None = None  # what soil does to the wheels; None on rigid ground

    @property
    def traversal(self) -> tuple[float, ...]:
        """Returns the values of /rover/truth/traversal, in its order."""
        touched = (self.contact_force, self.rock_contact, self.scrape)
        soil = () if self.soil is None else self.soil.values
        return (*touched, self.speed, self.path_length, *self.slip, self.roughness, *soil)


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """Contacts of one kind, none of them more than half a second after the one before."""

    # with what: any part with a hazard, any part with a rock, or the body (all but the wheels)
    # with the ground, which is a scrape
    kind: ContactKind
    # start of the clock tick in which it began; `end_ns` is the end of that in which it ended, so
    # that no event is shorter than a tick
    start_ns: int
    end_ns: int
    part: str  # which part of the rover, as its model names it, e.g. "wheel_FL", "chassis"
    other: str  # name of the obstacle in the model, e.g. "hazard_3", or "ground"
    # largest normal force at one contact point in one physics step [N]; `part`, `other` and
    # `point` are those of that moment
    force: float
    point: Vector3  # where on the rover, in its model frame [m]


@dataclass(frozen=True, slots=True)
class Truth:
    """What only the simulator knows of a drive: totals from the start of the episode."""

    time_ns: int = 0  # simulation time that they cover
    path_length: float = 0.0  # length of the model frame's path in three dimensions [m]
    position: Vector3 = (0.0, 0.0, 0.0)  # where that frame is now [m]
    hazard_contacts: int = 0  # contact events of any rover part with a hazard
    rock_contacts: int = 0  # contact events of any rover part with a rock
    scrapes: int = 0  # contact events of the body with the ground
    hazard_contact_s: float = 0.0  # time in contact with a hazard [s]
    rock_contact_s: float = 0.0  # time in contact with a rock [s]
    scrape_s: float = 0.0  # time of scraping [s]
    mean_slip: float = 0.0
    # mean magnitude of each wheel's slip ratio, over the times at which its rim or its centre
    # moves at 0.05 m/s or more, 0..1, at 20 Hz; `mean_slip` is that over all wheels
    wheel_slip: tuple[float, ...] = ()
    largest_tilt: float = 0.0  # largest angle between the rover's and the world's vertical [rad]
    tipped_over: bool = False  # the rover has lain on its side or roof
    resets: int = 0  # how often it was put back to its start; the way back is not in `path_length`


@dataclass(frozen=True, slots=True)
class Tick:
    """All samples that fall on one clock tick, in publishing order."""

    stamp_ns: int
    samples: tuple[Sample, ...]
    tells_time: bool = True  # whether /clock says the stamp; a fault may silence it

    def of(self, kind: type[S]) -> S | None:
        """Returns the first sample of a type; None if this tick has none."""
        for sample in self.samples:  # a generator takes twice as long
            if isinstance(sample, kind):
                return sample
        return None


@dataclass(frozen=True, slots=True)
class PlacedScan:
    """A scan and the pose of the model frame at the very tick of the scan."""

    scan: LaserScan
    pose: Pose
