"""Records a run's topics into an MCAP file, as `ros2 bag` would, on simulation time.

The file depends on nothing but the episode: no wall time, no leftover memory in the padding. A chunk
goes to the operating system every simulated second (or MiB), so a killed run loses less than its last
simulated second; such a file lacks its end, which `mcap recover FILE -o MENDED` writes.
rover_metrics.replay reads either.
"""

from collections import deque
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple, Self
from uuid import uuid4

from mcap.writer import CompressionType, Writer

from harness.base.errors import RunFailed, UsageError
from harness.base.files import check_target
from harness.base.message_types import typestore
from harness.base.sim_time import NANOSECONDS
from harness.base.version import __version__
from harness.messages.cdr import without_padding
from harness.messages.sink import Endpoint, Intake

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

    def forget(self) -> None:
        """Gives up what is not written yet."""
        self._held.clear()
        self._late.clear()
        self._latched.clear()

    def open(self, endpoint: Endpoint) -> Intake:
        """Returns where the messages of a topic go.

        Raises:
            UsageError: Nobody knows the type of its messages.
        """
        name = endpoint.message_type
        if name not in typestore().types:
            raise UsageError(f"--record needs the definition of {name}, which rosbags does not know")
        topic = _Topic(self._register(endpoint), name, is_foreign=endpoint.is_foreign)
        if endpoint.latched:
            self._latched[topic] = None
        take = self._late.append if endpoint.is_late else self._take
        return Intake(lambda time_ns, data: take(_Held(time_ns, topic, data)), lambda: True)

    def _register(self, endpoint: Endpoint) -> int:
        name = endpoint.message_type
        if name not in self._schemas:
            definition = full_definition(name).encode()
            self._schemas[name] = self._writer.register_schema(name, "ros2msg", definition)
        offered = QOS_PROFILE.format(**endpoint._asdict())
        metadata = {"offered_qos_profiles": offered, "topic_type_hash": typestore().hash_rihs01(name)}
        return self._writer.register_channel(endpoint.topic, "cdr", self._schemas[name], metadata)

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
            self._write(each)

    def _write(self, message: "_Held") -> None:
        (time_ns, topic, data), writer = message, self._writer
        if topic.is_foreign:
            data = without_padding(data, topic.type_name)
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
    """A channel of the file; what of it is foreign has padding."""

    number: int
    type_name: str
    is_foreign: bool


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
