"""/tf, /tf_static and /robot_description: samples and a Description -> bytes."""

from collections.abc import Callable, Sequence

from harness.base.message_types import made, read_message
from harness.base.sim_time import NANOSECONDS
from harness.messages.blank import cdr
from harness.messages.cdr import Template, places
from harness.robots.frames.tree import Edge
from harness.samples import Transforms
from harness.sensors.table import Topic

TF_MESSAGE = "tf2_msgs/msg/TFMessage"
STATIC = Topic("tf_static", TF_MESSAGE, depth=1, latched=True)  # as tf2_ros and robot_state_publisher
DESCRIPTION = Topic("robot_description", "std_msgs/msg/String", depth=1, latched=True)


class MovingFrames:
    """Makes the messages of samples of the same frames (parents, children), or of the first of them."""

    def __init__(self, frames: Sequence[tuple[str, str]] = ()) -> None:
        self._frames = frames
        self._fills: dict[int, Callable[[Transforms], bytes]] = {}

    def fill(self, sample: Transforms) -> bytes:
        """Returns the TFMessage of a sample."""
        count = len(sample.translation) // 3
        if count not in self._fills:
            self._fills[count] = transform_fill(self._frames[:count])
        return self._fills[count](sample)


def urdf_bytes(urdf: str) -> bytes:
    """Returns a String of a robot description."""
    return cdr(made(DESCRIPTION.message_type, urdf))


def transforms_bytes(edges: Sequence[Edge]) -> bytes:
    """Returns a TFMessage of frames in their parents, with stamp 0."""
    stamp = made("builtin_interfaces/msg/Time", 0, 0)
    transforms = [
        made(
            "geometry_msgs/msg/TransformStamped",
            made("std_msgs/msg/Header", stamp, edge.parent),
            edge.child,
            made(
                "geometry_msgs/msg/Transform",
                made("geometry_msgs/msg/Vector3", *edge.translation),
                made("geometry_msgs/msg/Quaternion", *edge.rotation),
            ),
        )
        for edge in edges
    ]
    return cdr(made(TF_MESSAGE, transforms))


def transform_fill(frames: Sequence[tuple[str, str]]) -> Callable[[Transforms], bytes]:
    """Returns what makes a TFMessage's bytes of each sample of the same parents and children."""
    data = transforms_bytes([Edge(*names) for names in frames])
    place_of = places(read_message(data, TF_MESSAGE), TF_MESSAGE)
    fields = ("header.stamp", "transform")
    template = Template(
        data, [place_of[f"transforms[{i}].{f}"] for i in range(len(frames)) for f in fields]
    )
    parts = [(slice(3 * i, 3 * i + 3), slice(4 * i, 4 * i + 4)) for i in range(len(frames))]

    def fill(sample: Transforms) -> bytes:
        stamp = divmod(sample.stamp_ns, NANOSECONDS)
        moved, turned = sample.translation, sample.rotation
        numbers: list[tuple[float, ...]] = []
        for of_moved, of_turned in parts:
            numbers += stamp, moved[of_moved] + turned[of_turned]
        return template.filled(numbers)

    return fill
