"""What is read of messages of which every field has a value of its own, by all who read any."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any
from zlib import crc32

import numpy as np

from harness.base.message_types import typestore
from harness.robots import REAL, ROVERS, equipped
from harness.scenario import maps, poses
from harness.validate.recordings.bags import TAKEN, Take
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS
from rover_metrics.extended.settings import DEFAULT_EXTENDED
from rover_metrics.session import MetricsSession
from rover_metrics.topics import ENERGY, SENSORS, TRUTH, Source, stamp_ns
from tests.support.snapshots import check_snapshot

HUSKY = equipped(ROVERS["husky"], REAL, "")
GIVEN: dict[str, Any] = {  # without which a message is none
    "OccupancyGrid/info/width": 3,
    "OccupancyGrid/info/height": 2,
    "OccupancyGrid/data": np.arange(-1, 5, dtype=np.int8) * 20,
    "GridMap/layers": ["height", "traversability"],
    "GridMap/data/layout/dim/size": 2,
    "GridMap/data/data": np.arange(4, dtype=np.float32) / 5,
    "GridMap/outer_start_index": 1,
    "JointState/name": list(HUSKY.wheel_joints),
    "Imu/orientation_covariance": np.zeros(9),
}


def made(kind: str, path: str = "") -> Any:  # noqa: ANN401 - rosbags makes its classes
    """Returns a message whose numbers and texts are those of their places."""
    path = path or kind.rpartition("/")[2]
    _, fields = typestore().fielddefs[kind]
    values: dict[str, Any] = {name: GIVEN.get(f"{path}/{name}") for name, _ in fields}
    for name, (node, of) in fields:
        if values[name] is None:
            values[name] = _value(node.name, of, f"{path}/{name}")
    return typestore().types[kind](**values)


def _value(node: str, of: Any, path: str) -> Any:  # noqa: ANN401 - as above
    number = crc32(path.encode()) % 90 + 5
    if node == "NAME":
        return made(of, path)
    if node == "BASE":
        kind = of[0]
        if kind in ("bool", "string"):
            return True if kind == "bool" else f"/{path}"
        return number / 10 if kind.startswith("float") else number
    (inner, what), size = of
    is_short = inner.name != "BASE" or path == "Float64MultiArray/data"
    count = size if node == "ARRAY" else 2 if is_short else 4
    many = [_value(inner.name, what, path) for _ in range(count)]
    if inner.name == "BASE" and what[0] != "string":
        return np.array(many, dtype=what[0]) + np.arange(count, dtype=what[0])
    return many


def readers() -> Iterator[tuple[str, str, Callable[[Any], object]]]:
    """Who reads a message of which type, and how."""
    for kind in maps.TYPES:
        yield "map", kind, lambda some: [(vars(one), one.places()) for one in maps.grids_of(some)]
    for kind in poses.TYPES:
        yield "pose", kind, lambda message: list(poses.rows_of(message))
    for kind, word, taken in TAKEN:
        yield f"recording {word}", kind, partial(_taken, taken)
    for source in (*SENSORS, *TRUTH, *ENERGY):
        for kind in (source.message_type, *source.also):
            yield f"metrics {source.name}", kind, partial(row_of, source)


def _taken(take: Take, message: Any) -> object:  # noqa: ANN401 - as above
    return take(message, HUSKY)


def row_of(source: Source, message: Any) -> list[object]:  # noqa: ANN401 - as above
    """The remark on a message, and the cells of a row that it has changed."""
    session, untouched = (MetricsSession(DEFAULT_THRESHOLDS, DEFAULT_EXTENDED) for _ in range(2))
    remark = source.take(session, message, stamp_ns(message) if source.has_stamp else 0)
    row, before = session.row(10**9), untouched.row(10**9)
    cells = zip(row.columns, row.as_fields(), before.as_fields(), strict=True)
    return [remark, {name: cell for name, cell, was in cells if cell != was}]


def told(value: object) -> str:
    """A value by its numbers, to six digits."""
    if isinstance(value, np.ndarray | float):
        return np.array2string(np.asarray(value, float).ravel(), precision=5)
    if isinstance(value, dict):
        return told([part for pair in value.items() for part in pair])
    if isinstance(value, list | tuple):
        return f"({', '.join(map(told, value))})"
    return repr(value)


def test_of_each_message_what_somebody_has_looked_at_is_read() -> None:
    lines = [f"{who} {kind}: {told(read(made(kind)))}" for who, kind, read in readers()]
    check_snapshot("read.txt", "\n".join(lines) + "\n")
