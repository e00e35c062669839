"""Reads an MCAP file of rosbag2: whole, without its end, or with damaged chunks."""

import io
import struct
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import NamedTuple

import zstandard
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.stream_reader import StreamReader, breakup_chunk

from rover_metrics.errors import RoverMetricsError
from rover_metrics.timing import NANOSECONDS

LARGEST_RECORD = 2**30  # bytes; a longer one is a damaged length
_CUT_OFF = "as when a recording is killed or cut off"

# What reading damaged bytes as MCAP raises; lz4 has no better type than RuntimeError.
_DAMAGE = (
    *(McapError, struct.error, zstandard.ZstdError),
    *(KeyError, MemoryError, OSError, RuntimeError, ValueError),
)


class BagError(RoverMetricsError):
    """A path that is no rosbag2 recording, or a file of one of which nothing can be read."""


class Message(NamedTuple):
    """One recorded message."""

    topic: str
    time_ns: int  # on the recorder's clock
    data: bytes  # CDR; empty where they were not asked for


def absolute(topic: str) -> str:
    """Returns a topic's full name, of which other programs than rosbag2 leave the first slash out."""
    return f"/{topic.strip().lstrip('/')}"


class McapFile:
    """An MCAP file, finished or not; `topics` has the message type of each topic with messages."""

    def __init__(self, path: Path) -> None:
        self._path, self._is_damaged = path, False  # beside having no end
        summarised = self._summarised_topics()
        self.topics = self._scanned_topics() if summarised is None else summarised

    def messages(self, wanted: Collection[str], problems: list[str]) -> Iterator[Message]:
        """Yields each message, in the order of the file."""
        topics: dict[int, str] = {}
        for record in self._records(problems):
            if isinstance(record, records.Message) and record.channel_id in topics:
                topic = topics[record.channel_id]
                yield Message(topic, record.log_time, record.data if topic in wanted else b"")
            elif isinstance(record, records.Channel):
                topics[record.id] = absolute(record.topic)

    def _records(self, problems: list[str]) -> Iterator[records.McapRecord]:
        bad_chunks: list[records.Chunk] = []
        name = self._path.name
        with self._path.open("rb") as file:
            reader = StreamReader(file, emit_chunks=True, record_size_limit=LARGEST_RECORD)
            whole = 0  # bytes
            try:
                for record in reader.records:
                    whole = file.tell()
                    if not isinstance(record, records.Chunk):
                        yield record
                        continue
                    try:
                        unpacked = breakup_chunk(record, validate_crc=True)
                    except _DAMAGE:
                        bad_chunks.append(record)
                    else:
                        yield from unpacked
            except (EndOfFile, struct.error):
                file.seek(whole)
                yield from _records_of_a_cut_chunk(file.read(LARGEST_RECORD))
                problems.append(f"{name} has no end, {_CUT_OFF}; what is there was read {_mend(name)}")
            except _DAMAGE as error:
                self._is_damaged = True
                problems.append(
                    f"{name} is damaged before byte {file.tell()} ({error}); what follows is lost"
                )
        if bad_chunks:
            self._is_damaged = True
            first = bad_chunks[0].message_start_time / NANOSECONDS
            problems.append(
                f"{name}: {len(bad_chunks)} damaged chunk(s) left out, the first from t = {first:.2f} s"
            )

    def _summarised_topics(self) -> dict[str, str] | None:
        with self._path.open("rb") as file:
            try:
                summary = SeekingReader(file, record_size_limit=LARGEST_RECORD).get_summary()
            except _DAMAGE:
                return None
        if summary is None or summary.statistics is None or not summary.channels:
            return None
        counts = summary.statistics.channel_message_counts
        there = [channel for channel in summary.channels.values() if counts.get(channel.id)]
        return {absolute(channel.topic): _type(channel, summary.schemas) for channel in there}

    def _scanned_topics(self) -> dict[str, str]:
        """Topics and types of the channels that have a message, from the records themselves."""
        schemas: dict[int, records.Schema] = {}
        channels: dict[int, records.Channel] = {}
        topics: dict[str, str] = {}
        problems: list[str] = []
        for record in self._records(problems):
            if isinstance(record, records.Schema):
                schemas[record.id] = record
            elif isinstance(record, records.Channel):
                channels[record.id] = record
            elif isinstance(record, records.Message) and record.channel_id in channels:
                channel = channels[record.channel_id]
                topics[absolute(channel.topic)] = _type(channel, schemas)
        if problems and not topics:
            if not self._is_damaged:
                mend = _mend(self._path.name)
                raise BagError(f"it ends before its first message, {_CUT_OFF} {mend}")
            raise BagError(f"no message can be read; {'; '.join(problems)}")
        return topics


def _records_of_a_cut_chunk(rest: bytes) -> Iterator[records.McapRecord]:
    """Yields what is whole of a last chunk that was cut off; nothing of another record."""
    stream = ReadDataStream(io.BytesIO(rest))
    try:
        opcode, _ = stream.read1(), stream.read8()
        if opcode == Opcode.CHUNK:
            chunk = records.Chunk.read(stream)  # its data as far as they go
            data = chunk.data if chunk.compression in ("", "zstd") else b""
            if chunk.compression:
                most = min(chunk.uncompressed_size, LARGEST_RECORD)
                data = zstandard.ZstdDecompressor().stream_reader(data).read(most)
            yield from StreamReader(io.BytesIO(data), skip_magic=True).records
    except _DAMAGE:
        return


def _mend(name: str) -> str:
    return f"(to mend the file: mcap recover {name} -o mended.mcap)"


def _type(channel: records.Channel, schemas: dict[int, records.Schema]) -> str:
    if channel.message_encoding != "cdr":
        return f"{channel.message_encoding}-encoded"
    schema = schemas.get(channel.schema_id)
    return schema.name if schema else "of an unknown type"
