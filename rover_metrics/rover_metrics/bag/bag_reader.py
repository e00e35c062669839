"""Reads rosbag2 recordings without ROS: a bag folder or a bare .mcap or .db3 file, whole or damaged.

Messages come in the order in which they were recorded. What cannot be read is left out and reported in
`Bag.problems`. The readers of rosbags sort by time, which hides a recorder's clock that was set back,
leave out a database's write-ahead log and end at the first damage.
"""

import io
import re
import shutil
import sqlite3
import tempfile
from collections.abc import Collection, Iterator
from contextlib import ExitStack, closing
from itertools import islice
from pathlib import Path, PurePath
from typing import Any, BinaryIO

import zstandard

from rover_metrics.bag.mcap_stream import LARGEST_RECORD, BagError, McapFile, Message, absolute
from rover_metrics.bag.order import in_time
from rover_metrics.errors import reason_of
from rover_metrics.log.documents import DocumentError, read_yaml
from rover_metrics.log.files import packer_of

LARGEST_SKIP = 2**32  # rows
LARGEST_UNPACKED = 2**36  # [bytes] of a compressed file, which half of what is free must hold too
UNPACK = "if that is meant, unpack it where there is room, with zstd -d, and name what comes of it"
MOST_NAMED = 5  # bags, where the folder that holds them was given
SUFFIXES = (".mcap", ".db3", ".mcap.zstd", ".db3.zstd")
MCAP_MAGIC = b"\x89MCAP0\r\n"
SQLITE_MAGIC = b"SQLite format 3\0"
ROS1_MAGIC = b"#ROSBAG"
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"


class SqliteFile:
    """A .db3 file of rosbag2; `topics` has the message type of each topic with messages."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._names: dict[int, str] = {}
        self.topics: dict[str, str] = {}
        try:
            with closing(self._connect()) as database:
                for key, name, kind in database.execute("SELECT id, name, type FROM topics"):
                    self._names[key] = absolute(str(name))
                    if _has_messages(database, key):
                        self.topics[self._names[key]] = str(kind)
        except sqlite3.Error as error:
            raise BagError(f"not readable as a rosbag2 database ({error})") from error

    def messages(self, wanted: Collection[str], problems: list[str]) -> Iterator[Message]:
        """Yields each message in the order of recording; past a bad page, ever further ahead."""
        keys = ",".join(str(key) for key, name in self._names.items() if name in wanted)
        query = (
            "SELECT id, topic_id, timestamp, "  # noqa: S608 - the keys are whole numbers
            f"CASE WHEN topic_id IN ({keys}) THEN data END FROM messages WHERE id > ? ORDER BY id"
        )
        gaps: list[str] = []
        after, skip = -1, 1
        with closing(self._connect()) as database:
            while skip < LARGEST_SKIP:
                try:
                    for row_id, key, time_ns, data in database.execute(query, (after,)):
                        if row_id <= after:  # of a page that is not there: it would come for ever
                            raise sqlite3.DatabaseError("rows out of order")
                        after, skip = row_id, 1
                        if key in self._names and isinstance(time_ns, int):
                            known = data if isinstance(data, bytes) else b""
                            yield Message(self._names[key], time_ns, known)
                    break
                except sqlite3.Error as error:
                    if skip == 1:
                        gaps.append(f"after row {after} ({error})")
                    after, skip = after + skip, skip * 2
        if gaps:
            problems.append(
                f"{self._path.name} is damaged; messages were lost in {len(gaps)} place(s), "
                f"the first {gaps[0]}"
            )

    def _connect(self) -> sqlite3.Connection:
        """Opens for reading; nothing is written, unless a write-ahead log has to be taken in."""
        wal = self._path.with_name(f"{self._path.name}-wal")
        mode = "mode=ro" if wal.exists() else "mode=ro&immutable=1"
        database = sqlite3.connect(f"{self._path.absolute().as_uri()}?{mode}", uri=True)
        # Lets SQLite open a file that is shorter than its header says.
        database.execute("PRAGMA writable_schema=ON")
        return database


class Bag(ExitStack):
    """A recording in a bag folder or a storage file; a context manager.

    Attributes:
        topics: Message type by topic, for the topics that hold messages.
        problems: What could not be read so far, a line each.

    Raises:
        BagError: There is nothing to read.
    """

    def __init__(self, path: str | Path) -> None:
        super().__init__()
        self.path = Path(path)
        self.problems: list[str] = []
        self._message_compression = False
        try:
            self._files = self._opened(self._paths())
        except BaseException:
            self.close()
            raise
        self.topics = {t: _full_name(kind) for file in self._files for t, kind in file.topics.items()}

    def messages(self, wanted: Collection[str]) -> Iterator[Message]:
        """Yields all messages in recorded order, those of the wanted topics with their bytes.

        Where topics were written one after another, or in files of their own, the wanted ones alone, in
        the order of their times.
        """
        for message in in_time(self._written, wanted, self.problems):
            # A bare file does not say so; CDR begins with a zero.
            is_packed = self._message_compression or message.data.startswith(ZSTD_MAGIC)
            yield self._decompressed(message) if is_packed else message

    def _written(self, wanted: Collection[str], problems: list[str]) -> Iterator[Message]:
        for file in self._files:
            yield from file.messages(wanted, problems)

    def _paths(self) -> list[Path]:
        if not self.path.exists():
            raise BagError(f"{self.path} does not exist")
        if not self.path.is_dir():
            return [self.path]
        there = sorted((p for p in self.path.iterdir() if p.name.endswith(SUFFIXES)), key=_natural)
        if not there:
            # Names of a few bags among the folders in this one; nothing deeper is looked at.
            files = (path for suffix in SUFFIXES for path in self.path.glob(f"*/*{suffix}"))
            below = sorted(islice(dict.fromkeys(path.parent.name for path in files), MOST_NAMED))
            hint = f"; bags in it: {', '.join(below)}" if below else ""
            raise BagError(f"{self.path} is no bag: the folder holds no .mcap and no .db3 file{hint}")
        return self._listed_paths() or there

    def _listed_paths(self) -> list[Path]:
        metadata_file = self.path / "metadata.yaml"
        if not metadata_file.exists():
            self.problems.append(
                "the bag has no metadata.yaml (a killed recording?); its files were read by name"
            )
            return []
        try:
            metadata = read_yaml(metadata_file)["rosbag2_bagfile_information"]
            paths = [self.path / PurePath(name).name for name in metadata["relative_file_paths"]]
            self._message_compression = str(metadata.get("compression_mode")).lower() == "message"
        except (DocumentError, ValueError, LookupError, TypeError, AttributeError):
            self.problems.append("metadata.yaml is not readable; the bag's files were read by name")
            return []
        self.problems.extend(f"{p.name} is missing from the bag" for p in paths if not p.exists())
        return [path for path in paths if path.exists()]

    def _opened(self, paths: list[Path]) -> list[McapFile | SqliteFile]:
        files: list[McapFile | SqliteFile] = []
        refusals: list[str] = []
        for path in paths:
            try:
                files.append(self._file(path))
            except (BagError, OSError) as error:  # noqa: PERF203 - one bad file of several
                refusals.append(f"{path.name}: {reason_of(error)}")
        if not files:
            raise BagError("; ".join(refusals))
        self.problems.extend(f"{refusal}; left out" for refusal in refusals)
        return files

    def _file(self, path: Path) -> McapFile | SqliteFile:
        start = _first_bytes(path)
        if start.startswith(ZSTD_MAGIC):
            path = self._decompressed_file(path)
            start = _first_bytes(path)
        if start.startswith(MCAP_MAGIC):
            return McapFile(path)
        if start.startswith(SQLITE_MAGIC):
            return SqliteFile(path)
        if start.startswith(ROS1_MAGIC):
            raise BagError("a ROS 1 bag; convert it: rosbags-convert --src FILE --dst FOLDER")
        if packer := packer_of(start):
            raise BagError(f"it is packed by {packer}; unpack it first")
        raise BagError("neither MCAP nor sqlite3" if start else "the file is empty")

    def _decompressed_file(self, path: Path) -> Path:
        folder = self.enter_context(tempfile.TemporaryDirectory(prefix="replay_"))
        target = Path(folder) / path.stem
        most = min(LARGEST_UNPACKED, shutil.disk_usage(folder).free // 2)
        with path.open("rb") as packed, target.open("wb") as unpacked:
            try:
                _unpack(packed, unpacked, most)
            except zstandard.ZstdError as error:
                self.problems.append(f"{path.name} is damaged ({error}); the rest of it is lost")
        return target

    @staticmethod
    def _decompressed(message: Message) -> Message:
        data = io.BytesIO()
        try:
            _unpack(io.BytesIO(message.data), data, LARGEST_RECORD)
        except (zstandard.ZstdError, BagError):
            return message._replace(data=b"")  # counts as an unreadable message of its topic
        return message._replace(data=data.getvalue())


def _unpack(packed: BinaryIO, unpacked: BinaryIO, most: int) -> None:
    """Unpacks into a file; BagError if that takes more bytes than `most`."""

    class Bounded(io.BytesIO):
        def write(self, part: Any, /) -> int:  # noqa: ANN401 - bytes, as zstandard gives them
            if unpacked.tell() + len(part) > most:
                raise BagError(f"it unpacks to more than {most >> 20:,} MiB; {UNPACK}")
            return unpacked.write(part)

    zstandard.ZstdDecompressor().copy_stream(packed, Bounded())


def _first_bytes(path: Path) -> bytes:
    if not path.is_file():  # a pipe would wait for its writer
        raise BagError("this is not a file but a device or a pipe")
    with path.open("rb") as file:
        return file.read(len(SQLITE_MAGIC))


def _full_name(message_type: str) -> str:
    """The type with its /msg/, which older recorders leave out."""
    package, _, name = message_type.rpartition("/")
    return message_type if "/" in package or not package else f"{package}/msg/{name}"


def _natural(path: Path) -> list[int | str]:
    """Sort key that puts bag_2 before bag_10."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", path.name)]


def _has_messages(database: sqlite3.Connection, topic: int) -> bool:
    """Whether a topic has messages; where the database is damaged, they are only to be hoped for."""
    try:
        first = database.execute("SELECT 1 FROM messages WHERE topic_id = ? LIMIT 1", (topic,))
        return first.fetchone() is not None
    except sqlite3.DatabaseError:
        return True
