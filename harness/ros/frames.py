"""/tf, /tf_static and /robot_description of a run, as topics of its bridge.

A TFMessage goes out as bytes, so it needs no tf2_msgs (foreign_type).
"""

from collections import deque

from rclpy.node import Node

from harness.base.errors import RunFailed
from harness.base.message_types import read_message
from harness.messages.transforms import (
    DESCRIPTION,
    STATIC,
    TF_MESSAGE,
    MovingFrames,
    transforms_bytes,
    urdf_bytes,
)
from harness.robots.frames.tree import ODOM, Description
from harness.ros.channel import open_channel
from harness.ros.context import owner_of
from harness.ros.foreign_type import FAST_DDS, forget_missing_definition, message_type
from harness.samples import Transforms
from harness.sensors.table import SENSORS
from rover_metrics.errors import shown
from rover_metrics.ros.parameters import BEST_EFFORT
from rover_metrics.ros.subscriptions import keep_last

NO_TYPE = (
    f"no /tf, no /tf_static: {TF_MESSAGE} is not installed, and only Fast DDS does without; "
    f"install tf2_msgs, or set RMW_IMPLEMENTATION={FAST_DDS}"
)
RECENT = 1000  # messages sent that may still come back


class FrameTopics:
    """What a bridge publishes of a rover's frames, and whether somebody else publishes it too.

    Args:
        node: The bridge.

    Attributes:
        moving: /tf, or nothing where its type is not to be had; `fixed` are the other topics.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        (tf,) = (row for row in SENSORS if row.sample is Transforms)
        has_type = message_type(TF_MESSAGE) is not None
        if not has_type:
            node.get_logger().warning(NO_TYPE)
        self.moving = [open_channel(node, topic, self._fill) for topic in tf.topics if has_type]
        self._static = [open_channel(node, STATIC, transforms_bytes)] if has_type else []
        self._urdf = open_channel(node, DESCRIPTION, urdf_bytes)
        self.fixed = [self._urdf, *self._static]
        self._description = Description((), (), owns_odom=False, urdf="")
        self._frames = MovingFrames()
        self._sent: deque[bytes] = deque(maxlen=RECENT)
        self._watched = False
        self._rival: str | None = None

    def describe(self, description: Description) -> None:
        """Publishes what is fixed; the samples to come are of what moves."""
        self._description, self._frames = description, MovingFrames(description.moving)
        self._urdf.publish(description.urdf)
        for channel in self._static:
            channel.publish(description.fixed)

    def _fill(self, sample: Transforms) -> bytes:
        data = self._frames.fill(sample)
        self._sent.append(data)
        return data

    def refuse_rivals(self) -> None:
        """Listens to /tf as soon as it has another publisher.

        Raises:
            RunFailed: Somebody else publishes a frame that is this run's.
        """
        for channel in self.moving if self._owned() else ():
            if self._rival is not None:
                raise RunFailed(f"{channel.topic} {self._rival}")
            if not self._watched and self._node.count_publishers(channel.topic) > 1:
                self._watched = True
                kind, qos = channel.publisher.msg_type, keep_last(100, BEST_EFFORT)  # holds up nobody
                self._node.create_subscription(kind, channel.topic, self.hear, qos, raw=True)
                forget_missing_definition()

    def _owned(self) -> dict[str, str]:
        """The frames of whose parent only this run may tell, and what to give where another shall."""
        description = self._description
        owned = {description.moving[0][1]: "--odom-tf none"} if description.owns_odom else {}
        mapped = any(edge.child == ODOM for edge in description.fixed)
        return owned | ({ODOM: "no --map-tf"} if mapped else {})

    def hear(self, data: bytes) -> None:
        """Takes a message of /tf, of this run or of somebody else."""
        if data in self._sent:
            return
        owned = self._owned()
        for transform in read_message(data, TF_MESSAGE).transforms:
            parent, child = shown(transform.header.frame_id), transform.child_frame_id
            if child in owned:
                self._rival = (
                    f"has {parent} -> {child} from {self._others()} too, and a frame has one owner: "
                    f"stop it there, or give {owned[child]} here"
                )

    def _others(self) -> str:
        """The other nodes that publish it: no message says which of them it was."""
        names = {*map(owner_of, self._node.get_publishers_info_by_topic(self.moving[0].topic))}
        return " or ".join(sorted(names - {self._node.get_fully_qualified_name()})) or "another node"
