"""Records a run's topics into an MCAP file, as `ros2 bag` would, on simulation time.

What the bridge and the hosted metrics_node publish, and the commands that the bridge hears. The recorder
stands before the publishers: it serialises each message once, so the file holds exactly the published
bytes and no subscriber has to be waited for. The file depends on
nothing but the episode: no wall time, no leftover memory in the padding. A chunk goes to the operating
system every simulated second (or MiB), so a killed run loses less than its last simulated second; such
a file lacks its end, which `mcap recover FILE -o MENDED` writes. rover_metrics.replay reads either.
"""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple, Self
from uuid import uuid4

from mcap.writer import CompressionType, Writer
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rclpy.subscription import Subscription

from harness.base.errors import RunFailed, UsageError
from harness.base.files import check_target
from harness.base.sim_time import NANOSECONDS
from harness.base.version import __version__
from harness.ros.bridge import Bridge
from harness.ros.cdr import type_name, without_padding
from harness.ros.channel import Channel, Message
from harness.sensors.message_types import typestore
from rover_metrics.ros.metrics_publisher import MetricsPublisher

CHUNK_SIZE = 1024 * 1024  # [B]
SEPARATOR = "=" * 80 + "\n"

# What rosbag2 looks up before it reads a bare file: version 8 is the last whose QoS profiles are
# numbers, which every distribution understands. The zeros are placeholders; it counts for itself.
BAG_METADATA = """\
version: 8
storage_identifier: mcap
duration: {nanoseconds: 0}
starting_time: {nanoseconds_since_epoch: 0}
message_count: 0
topics_with_message_count: []
compression_format: ''
compression_mode: ''
relative_file_paths: []
files: []
custom_data: {}
ros_distro: ''
"""

QOS_PROFILE = """\
- history: {history}
  depth: {depth}
  reliability: {reliability}
  durability: {durability}
  deadline: {{sec: 9223372036, nsec: 854775807}}
  lifespan: {{sec: 9223372036, nsec: 854775807}}
  liveliness: 1
  liveliness_lease_duration: {{sec: 9223372036, nsec: 854775807}}
  avoid_ros_namespace_conventions: false
"""


class Recorder:
    """One recording; a context manager that finishes the file.

    Args:
        path: The file to create.
        overwrite: Whether it may exist: then it is replaced with the first message.
        last: How many seconds of simulation time are kept: then the file is written when it is finished,
            and what is latched (transient local) stays in it, as of the first of these seconds.

    Raises:
        UsageError: It cannot be created.
    """

    def __init__(self, path: Path, *, overwrite: bool = False, last: float | None = None) -> None:
        check_target("--record", path, ".mcap")
        self._path = self._made = path
        if path.exists() and not path.is_file():
            raise UsageError(f"--record {path} is a device or a pipe; name a file")
        if overwrite and (path.exists() or path.is_symlink()):
            self._made = path.with_name(f".{path.stem}-{uuid4().hex}.part")
        try:
            self._file = self._made.open("xb")
        except FileExistsError as error:
            message = (
                f"--record {path} exists already, not overwriting; name another file or --overwrite"
            )
            raise UsageError(message) from error
        self._writer = Writer(self._file, chunk_size=CHUNK_SIZE, compression=CompressionType.LZ4)
        self._schemas: dict[str, int] = {}
        self._next_flush_ns = 0
        self._last_ns = None if last is None else round(last * NANOSECONDS)
        self._held: deque[_Held] = deque()
        self._late: list[_Held] = []  # of the nodes' metrics, until the next other message
        self._latched: dict[_Topic, _Held | None] = {}  # the last that is no more among those
        self._messages = 0
        self._failed = False
        self._bridges: list[Bridge] = []

    def __enter__(self) -> Self:
        self._writer.start(profile="ros2", library=f"rover-harness {__version__}")
        self._writer.add_metadata("rosbag2", {"serialized_metadata": BAG_METADATA})
        return self

    def __exit__(self, *_: object) -> None:
        try:
            with self._file:
                if not self._failed:
                    self._write_held()
                self._writer.finish()  # type: ignore[no-untyped-call]  # mcap half types itself
        except OSError as full:
            if not self._failed:
                raise self._failure(full) from full
        finally:
            if not self._messages:  # the run did not come to its first message, or the disk is full
                self._made.unlink(missing_ok=True)

    def tap(
        self, bridge: Bridge, metrics: MetricsPublisher | None = None, others: Iterable[Channel] = ()
    ) -> None:
        """Records all that the bridge publishes and hears from now on, under the time of its tick.

        A message's own stamp may differ from that where a fault delays it or disturbs the clock.

        Args:
            bridge: A node of the run; of several, the first one tells the time.
            metrics: Of the hosted metrics_node, if there is one; it then publishes for nobody too.
            others: Topics of the run that are not the bridge's own.
        """
        self._bridges.append(bridge)
        for channel in (*bridge.channels, *others):
            # A channel's messages of one length differ in nothing else: their padding is the same.
            channel.record = self._recording(channel.topic, channel.publisher, {})
        bridge.commands.record(lambda topic, heard: self._recording(topic, heard, {}))
        if metrics is not None and metrics.publisher is not None:
            metrics.record = self._recording(
                metrics.publisher.topic_name, metrics.publisher, None, self._late.append
            )

    def forget(self) -> None:
        """Gives up what is not written yet."""
        self._held.clear()
        self._late.clear()
        self._latched.clear()

    def hear(self, topic: str, subscription: Subscription) -> Callable[[Message], object] | None:
        """Returns what records each message of a topic that is heard; None if nobody knows its type."""
        if type_name(subscription.msg_type) not in typestore().types:
            return None
        return self._recording(topic, subscription, None)

    def _recording(
        self,
        topic: str,
        endpoint: Publisher | Subscription,
        padding: dict[int, list[int]] | None,
        take: "Callable[[_Held], None] | None" = None,
    ) -> Callable[[Message], bytes]:
        """What records messages of a topic; `padding` keeps where it is in those of each length."""
        name, qos = type_name(endpoint.msg_type), endpoint.qos_profile
        recorded = _Topic(self._register(topic, name, qos), name, padding)
        if qos.durability == DurabilityPolicy.TRANSIENT_LOCAL:
            self._latched[recorded] = None
        return partial(self._record, take or self._take, recorded)

    def _register(self, topic: str, name: str, qos: QoSProfile) -> int:
        if name not in typestore().types:
            raise UsageError(f"--record needs the definition of {name}, which rosbags does not know")
        if name not in self._schemas:
            definition = full_definition(name).encode()
            self._schemas[name] = self._writer.register_schema(name, "ros2msg", definition)
        policies = ("history", "depth", "reliability", "durability")
        offered = QOS_PROFILE.format(**{policy: int(getattr(qos, policy)) for policy in policies})
        metadata = {"offered_qos_profiles": offered, "topic_type_hash": typestore().hash_rihs01(name)}
        return self._writer.register_channel(topic, "cdr", self._schemas[name], metadata)

    def _record(self, take: "Callable[[_Held], None]", topic: "_Topic", message: Message) -> bytes:
        """Records a message and returns its bytes."""
        written = message if isinstance(message, bytes) else serialize_message(message)
        if self._last_ns is None:
            written = without_padding(written, topic.type_name, topic.padding)
        take(_Held(self._bridges[0].time_ns, topic, written))
        return written

    def _take(self, message: "_Held") -> None:
        """Writes or holds a message, after those of metrics: several nodes publish them in any order."""
        self._take_late()
        self._put(message)

    def _take_late(self) -> None:
        late, self._late[:] = sorted(self._late, key=attrgetter("time_ns", "topic.number")), []
        for message in late:
            self._put(message)

    def _put(self, message: "_Held") -> None:
        if self._last_ns is None:
            self._write(message)
        else:
            self._hold(message, message.time_ns - self._last_ns)

    def _hold(self, message: "_Held", first_ns: int) -> None:
        """Keeps a message until it is too old; what is latched is not."""
        self._held.append(message)
        while self._held[0].time_ns < first_ns:
            old = self._held.popleft()
            if old.topic in self._latched:
                self._latched[old.topic] = old

    def _write_held(self) -> None:
        self._take_late()
        first_ns = self._held[0].time_ns if self._held else 0
        latched = [old._replace(time_ns=first_ns) for old in self._latched.values() if old is not None]
        for each in (*latched, *self._held):
            data = without_padding(each.written, each.topic.type_name, each.topic.padding)
            self._write(each._replace(written=data))

    def _write(self, message: "_Held") -> None:
        (time_ns, topic, data), writer = message, self._writer
        try:
            if time_ns >= self._next_flush_ns:
                writer.flush()  # type: ignore[no-untyped-call]
                self._next_flush_ns = (time_ns // NANOSECONDS + 1) * NANOSECONDS
            writer.add_message(topic.number, time_ns, data, publish_time=time_ns)
            if not self._messages and self._made != self._path:
                self._made.replace(self._path)
        except OSError as error:
            raise self._failure(error) from error
        self._messages += 1

    def _failure(self, error: OSError) -> RunFailed:
        self._failed = True
        return RunFailed(f"the recording {self._path} ended early: {error.strerror}")


@dataclass(frozen=True, eq=False)
class _Topic:
    """A channel of the file; `padding` is as for `without_padding`."""

    number: int
    type_name: str
    padding: dict[int, list[int]] | None


class _Held(NamedTuple):
    """A message on its way into the file, or one that may yet be too old to be kept."""

    time_ns: int
    topic: _Topic
    written: bytes


def full_definition(kind: str) -> str:
    """Returns a message's definition followed by those of the types in it, as rosbag2 stores it."""
    text, _ = typestore().generate_msgdef(kind, ros_version=2)
    definition, *nested = text.split(SEPARATOR)
    return SEPARATOR.join([definition, *sorted(nested)])
