"""A listener of another DDS implementation, Eclipse Cyclone DDS, whose types are written by hand.

It shares no code with the publisher: neither Fast DDS, nor rmw, nor rosbags. Imported only where PyPI's
`cyclonedds` is installed.
"""

import time
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.types import float32, float64, int8, int32, sequence, uint32
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

# As the harness: this machine alone, found without multicast.
LOOPBACK = """
<CycloneDDS><Domain>
  <General>
    <Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>
    <AllowMulticast>false</AllowMulticast>
  </General>
  <!-- Fast DDS (vendor 1.15) describes nested types otherwise: match by name, as ROS does. -->
  <Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation></Compatibility>
  <Discovery>
    <ParticipantIndex>auto</ParticipantIndex>
    <Peers><Peer address="127.0.0.1"/></Peers>
    <MaxAutoParticipantIndex>30</MaxAutoParticipantIndex>
  </Discovery>
</Domain></CycloneDDS>
"""


def message(name: str, **fields: Any) -> Any:  # noqa: ANN401 - a class
    """The class of a message, by its package and name, from the types of its fields."""
    package, name = name.split("/")
    return make_idl_struct(name, f"{package}::msg::dds_::{name}_", fields)


Time = message("builtin_interfaces/Time", sec=int32, nanosec=uint32)
Header = message("std_msgs/Header", stamp=Time, frame_id=str)
String = message("std_msgs/String", data=str)
Vector3 = message("geometry_msgs/Vector3", x=float64, y=float64, z=float64)
Quaternion = message("geometry_msgs/Quaternion", x=float64, y=float64, z=float64, w=float64)
Pose = message("geometry_msgs/Pose", position=Vector3, orientation=Quaternion)  # a Point has x, y, z too
Transform = message("geometry_msgs/Transform", translation=Vector3, rotation=Quaternion)
TransformStamped = message(
    "geometry_msgs/TransformStamped", header=Header, child_frame_id=str, transform=Transform
)
TFMessage = message("tf2_msgs/TFMessage", transforms=sequence[TransformStamped])  # type: ignore[misc]
MapMetaData = message(
    "nav_msgs/MapMetaData",
    map_load_time=Time,
    resolution=float32,
    width=uint32,
    height=uint32,
    origin=Pose,
)
OccupancyGrid = message("nav_msgs/OccupancyGrid", header=Header, info=MapMetaData, data=sequence[int8])  # type: ignore[misc]

LATCHED = {"rt/tf_static": TFMessage, "rt/robot_description": String, "rt/map": OccupancyGrid}


class CycloneListener:
    """Listens to /tf from its beginning and, when told to, to what is latched.

    Args:
        domain: The ROS domain.

    Attributes:
        moving: What came on /tf; `latched`: the first message of each other topic.
    """

    def __init__(self, domain: int) -> None:
        self._domain = Domain(domain, LOOPBACK)
        self._participant = DomainParticipant(domain)
        self._tf = self._reader("rt/tf", TFMessage, Policy.Durability.Volatile, 100)
        self.moving: list[Any] = []
        self.latched: dict[str, Any] = {}

    def take(self) -> None:
        """Takes what came on /tf."""
        self.moving += self._tf.take(N=100)

    def join_late(self, patience: float) -> None:
        """Waits so long [s] for the first message of each latched topic, which has been sent before."""
        readers = {
            n: self._reader(n, k, Policy.Durability.TransientLocal, 1) for n, k in LATCHED.items()
        }
        end = time.monotonic() + patience
        while len(self.latched) < len(readers) and time.monotonic() < end:
            for name, reader in readers.items():
                for message in reader.take_iter(timeout=duration(milliseconds=20)):
                    self.latched[name] = message

    def _reader(self, name: str, kind: Any, durability: Any, depth: int) -> Any:  # noqa: ANN401
        qos = Qos(
            Policy.Reliability.Reliable(duration(seconds=1)), durability, Policy.History.KeepLast(depth)
        )
        return DataReader(self._participant, Topic(self._participant, name, kind), qos=qos)
