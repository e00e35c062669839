"""Reads rosbag2 recordings without ROS: a bag folder or a bare .mcap or .db3 file, whole or damaged.

Messages come in the order in which they were recorded. What cannot be read is left out and told in
`Bag.problems`; everything else is kept: the chunks before and after a damaged one, the rows of a
database around a bad page, a recording that was killed before it could write its end or its folder's
metadata.yaml.
"""

import re
import tempfile
from collections.abc import Collection, Iterator
from contextlib import ExitStack
from pathlib import Path, PurePath
from types import TracebackType
from typing import Any

import zstandard
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from rover_metrics.bag.mcap_stream import McapFile
from rover_metrics.bag.message import BagError, Message, UnreadableError
from rover_metrics.bag.sqlite import SqliteFile

SUFFIXES = (".mcap", ".db3", ".mcap.zstd", ".db3.zstd")
MCAP_MAGIC = b"\x89MCAP0\r\n"
SQLITE_MAGIC = b"SQLite format 3\0"
ROS1_MAGIC = b"#ROSBAG"
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"


class Bag:
    """A recording; a context manager.

    Args:
        path: A bag folder or a storage file.

    Attributes:
        topics: Message type by topic, for the topics that hold messages.
        problems: What could not be read so far, a line each.

    Raises:
        BagError: There is nothing to read.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.problems: list[str] = []
        self._at_end = ExitStack()
        self._message_compression = False
        self._files: list[McapFile | SqliteFile] = []
        try:
            self._open(self._paths())
        except BaseException:
            self._at_end.close()
            raise
        self.topics = {topic: kind for file in self._files for topic, kind in file.topics.items()}

    def __enter__(self) -> "Bag":
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._at_end.close()

    def messages(self, wanted: Collection[str]) -> Iterator[Message]:
        """Yield all messages in recorded order, those of the wanted topics with their bytes."""
        for file in self._files:
            for message in file.messages(wanted, self.problems):
                yield self._decompressed(message) if self._message_compression else message

    def _paths(self) -> list[Path]:
        """The storage files in order, from metadata.yaml where there is one."""
        if not self.path.exists():
            raise BagError(f"{self.path} does not exist")
        if not self.path.is_dir():
            return [self.path]
        there = sorted((p for p in self.path.iterdir() if p.name.endswith(SUFFIXES)), key=_natural)
        if not there:
            raise BagError(f"{self.path} is no bag: the folder holds no .mcap and no .db3 file")
        return self._listed_paths() or there

    def _listed_paths(self) -> list[Path]:
        metadata_file = self.path / "metadata.yaml"
        if not metadata_file.exists():
            self.problems.append(
                "the bag has no metadata.yaml (a killed recording?); its files were read by name"
            )
            return []
        try:
            metadata: dict[str, Any] = YAML(typ="safe").load(metadata_file)[
                "rosbag2_bagfile_information"
            ]
            paths = [self.path / PurePath(name).name for name in metadata["relative_file_paths"]]
            self._message_compression = str(metadata.get("compression_mode")).lower() == "message"
        except (OSError, YAMLError, ValueError, KeyError, TypeError, AttributeError):
            self.problems.append("metadata.yaml is not readable; the bag's files were read by name")
            return []
        self.problems.extend(f"{p.name} is missing from the bag" for p in paths if not p.exists())
        return [path for path in paths if path.exists()]

    def _open(self, paths: list[Path]) -> None:
        """Open what can be opened; only if that is nothing it is an error."""
        refusals: list[str] = []
        for path in paths:
            try:
                self._files.append(self._opened(path))
            except (UnreadableError, OSError) as error:  # noqa: PERF203 - one bad file of several
                reason = error.strerror if isinstance(error, OSError) else error
                refusals.append(f"{path.name}: {reason}")
        if not self._files:
            raise BagError("; ".join(refusals))
        self.problems.extend(f"{refusal}; left out" for refusal in refusals)

    def _opened(self, path: Path) -> McapFile | SqliteFile:
        """Open a file as what its first bytes say it is."""
        if _first_bytes(path).startswith(ZSTD_MAGIC):
            path = self._decompressed_file(path)
        start = _first_bytes(path)
        if start.startswith(MCAP_MAGIC):
            return McapFile(path)
        if start.startswith(SQLITE_MAGIC):
            return SqliteFile(path)
        if start.startswith(ROS1_MAGIC):
            raise UnreadableError("a ROS 1 bag; convert it: rosbags-convert --src FILE --dst FOLDER")
        raise UnreadableError("neither MCAP nor sqlite3" if start else "the file is empty")

    def _decompressed_file(self, path: Path) -> Path:
        folder = self._at_end.enter_context(tempfile.TemporaryDirectory(prefix="replay_"))
        target = Path(folder) / path.stem
        with path.open("rb") as packed, target.open("wb") as unpacked:
            try:
                zstandard.ZstdDecompressor().copy_stream(packed, unpacked)
            except zstandard.ZstdError as error:
                self.problems.append(f"{path.name} is damaged ({error}); the rest of it is lost")
        return target

    @staticmethod
    def _decompressed(message: Message) -> Message:
        try:
            data = zstandard.ZstdDecompressor().decompressobj().decompress(message.data)
        except zstandard.ZstdError:
            data = b""  # counts as an unreadable message of its topic
        return message._replace(data=data)


def _first_bytes(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(len(SQLITE_MAGIC))


def _natural(path: Path) -> list[int | str]:
    """Sort key that puts bag_2 before bag_10."""
    parts = re.split(r"(\d+)", path.name)
    return [int(part) if part.isdigit() else part for part in parts]
