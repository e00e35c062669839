"""The shapes of what messages have in common, as expectations."""

from collections.abc import Mapping
from typing import Any

from tests.e2e.topic_oracle.twin import Twin

Expected = Mapping[str, Any]


def stamp(time_ns: int) -> Expected:
    """builtin_interfaces/Time."""
    return {"sec": time_ns // 10**9, "nanosec": time_ns % 10**9}


def header(twin: Twin, frame: str) -> Expected:
    """std_msgs/Header."""
    return {"stamp": stamp(twin.time_ns), "frame_id": frame}


def vector(values: Any) -> Expected:  # noqa: ANN401 - three numbers
    """geometry_msgs/Vector3 or Point."""
    return dict(zip("xyz", values, strict=True))
