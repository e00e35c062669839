"""Where numbers stand in a serialised message, and a template of one in which they are replaced.

To serialise a message object takes several times as long as to write what changes. The layout is that
of XCDR1 in little endian: each number is aligned to its size, counted from behind the encapsulation
header.
"""

import struct
from collections.abc import Sequence
from itertools import chain, pairwise
from typing import Any, NamedTuple

import numpy as np
from rosbags.interfaces import Nodetype

from harness.base.message_types import typestore

HEADER = 4  # [B]: of the encapsulation
LETTERS = {"bool": "?", "byte": "B", "char": "B", "float32": "f", "float64": "d"}
LETTERS |= {"int8": "b", "int16": "h", "int32": "i", "int64": "q"}
LETTERS |= {f"u{name}": letter.upper() for name, letter in LETTERS.items() if name.startswith("int")}
MANY = 32  # numbers, from which on they are copied as an array


class Place(NamedTuple):
    """Numbers in a message, `length` of that format of struct from `start` on; None: no list of them."""

    start: int
    letter: str
    length: int | None = None

    @property
    def end(self) -> int:
        """Returns where the next field may begin."""
        return self.start + struct.calcsize(f"<{self.format}")

    @property
    def format(self) -> str:
        """Returns the format of all."""
        return self.letter if self.length is None else f"{self.length}{self.letter}"


def places(message: Any, kind: str) -> dict[str, Place]:  # noqa: ANN401 - of rclpy or of rosbags
    """Returns where the numbers of a message are, by the paths of their fields.

    Args:
        message: A message object, whose texts and lists have the lengths that they shall have.
        kind: Its type, as in sensor_msgs/msg/LaserScan.

    Returns:
        A place for each field that is a number, a list of numbers, or made of a few numbers in a row, as
        transforms[0].transform; that of "" is empty, where the message ends.
    """
    walk = _Walk()
    walk.field((Nodetype.NAME, kind), message, "")
    return {**walk.places, "": Place(walk.at, "")}


class _Walk:
    """Goes through a message field by field."""

    def __init__(self) -> None:
        self.at, self.places = HEADER, dict[str, Place]()

    def field(self, node: Any, value: Any, path: str) -> None:  # noqa: ANN401 - of rosbags
        """Goes past a field and notes what is in it."""
        category, detail = node
        if category == Nodetype.NAME:
            self._fields(typestore().fielddefs[detail][1], value, path)
        elif category != Nodetype.BASE:
            self._list(detail[0], value, path, counted=category == Nodetype.SEQUENCE)
        elif detail[0] == "string":
            self._align(4)
            self.at += 4 + len(value.encode()) + 1
        else:
            self._numbers(LETTERS[detail[0]], None, path)

    def _fields(self, fields: Sequence[tuple[str, Any]], value: Any, path: str) -> None:  # noqa: ANN401
        names = [f"{path}.{name}".lstrip(".") for name, _ in fields]
        for below, (name, node) in zip(names, fields, strict=True):
            self.field(node, getattr(value, name), below)
        parts = [self.places.get(below) for below in names]
        row = [part for part in parts if part is not None and part.length is None]
        if row and len(row) == len(parts) and all(a.end == b.start for a, b in pairwise(row)):
            self.places[path] = Place(row[0].start, "".join(part.letter for part in row))

    def _list(self, node: Any, value: Any, path: str, *, counted: bool) -> None:  # noqa: ANN401
        if counted:
            self._align(4)
            self.at += 4
        letter = LETTERS.get(node[1][0]) if node[0] == Nodetype.BASE else None
        if letter is not None:
            self._numbers(letter, len(value), path)
            return
        for index, one in enumerate(value):
            self.field(node, one, f"{path}[{index}]")

    def _numbers(self, letter: str, count: int | None, path: str) -> None:
        if count != 0:  # an empty list is not padded
            self._align(struct.calcsize(letter))
        self.places[path] = Place(self.at, letter, count)
        self.at = self.places[path].end

    def _align(self, size: int) -> None:
        self.at += -(self.at - HEADER) % size


class Template:
    """The bytes of a serialised message, in which numbers are replaced at some places.

    All of it is packed in one go, what does not change as the bytes that it is: to write place by place
    takes twice as long.
    """

    def __init__(self, data: bytes, spots: Sequence[Place]) -> None:
        self._order = sorted(range(len(spots)), key=lambda index: spots[index].start)
        self._is_in_order = self._order == list(range(len(spots)))
        self._lengths = [(i, spot.length) for i, spot in enumerate(spots) if spot.length is not None]
        self._arrays = [(i, f"<{spots[i].letter}") for i, length in self._lengths if length > MANY]
        form, at = "<", 0
        self._parts: list[Sequence[Any]] = []  # by turns what does not change and what is given
        for spot in (spots[index] for index in self._order):
            size = spot.end - spot.start
            is_array = spot.length is not None and spot.length > MANY
            form += f"{spot.start - at}s{f'{size}s' if is_array else spot.format}"
            self._parts += [(data[at : spot.start],), ()]
            at = spot.end
        self._parts.append((data[at:],))
        self._pack = struct.Struct(f"{form}{len(data) - at}s").pack

    def fits(self, values: Sequence[Sequence[Any]]) -> bool:
        """Returns whether lists of numbers are as long as the message's."""
        return not self._lengths or all(len(values[index]) == n for index, n in self._lengths)

    def filled(self, values: Sequence[Sequence[Any]]) -> bytes:
        """Returns the message with these numbers, those of each place, which must fit."""
        if self._arrays:
            values = list(values)
            for index, kind in self._arrays:
                values[index] = (np.asarray(values[index], kind).tobytes(),)
        parts = self._parts
        parts[1::2] = values if self._is_in_order else [values[index] for index in self._order]
        return self._pack(*chain.from_iterable(parts))


def without_padding(written: bytes, kind: str) -> bytes:
    """Returns the bytes of a message as DDS has them, with zeros where they carry nothing."""
    buffer = bytearray(written)
    for position in padding_of(written, kind):
        buffer[position] = 0
    return bytes(buffer)


def padding_of(data: bytes, kind: str) -> list[int]:
    """Returns the positions of the bytes of a CDR message that align its fields and carry nothing.

    DDS leaves in them whatever was in memory. They are the bytes that writing the same message into a
    buffer of zeros and into one of ones leaves different; so are the closing zeros of strings, which
    rosbags does not write.
    """
    definition = typestore().get_msgdef(kind)
    body = len(data) - 4  # behind the encapsulation header
    # Not `deserialize_cdr`, which refuses what DDS leaves behind lists that are empty.
    try:
        message, _ = definition.deserialize_cdr_le(data[4:], 0, definition.cls, typestore())
    except struct.error as error:
        raise ValueError(f"no {kind}: {error}") from error
    buffers = bytearray(body), bytearray(b"\xff" * body)
    for buffer in buffers:
        definition.serialize_cdr_le(memoryview(buffer), 0, message, typestore())
    zeros, ones = (np.frombuffer(buffer, np.uint8) for buffer in buffers)
    return [4 + i for i in np.flatnonzero(zeros != ones).tolist()]
