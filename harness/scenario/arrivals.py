"""What was heard of topics, and what their quantities were over time.

They are of messages, or of the poses and maps in them, which the truth judges.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import unknown
from harness.base.message_types import numbers_at
from harness.base.sim_time import NANOSECONDS
from harness.episode.assembly import graded_world
from harness.scenario import maps, poses
from harness.scenario.case import Case
from harness.scenario.names import MAP, OF_TOPICS, POSE, HeardQuantity, heard_quantity
from harness.scenario.series import Series
from rover_metrics.topics import stamp_ns

SAMPLED_NS = NANOSECONDS // 20  # between two values of a rate

Integers = NDArray[np.int64]
Read = Callable[[Any], Iterable[Any]]


class Reader(NamedTuple):
    """Takes out of messages of these types what is judged."""

    types: Sequence[str]
    read: Read


@dataclass
class Arrivals:
    """The messages of one topic that were heard.

    `read` takes what is judged out of each message, into `read_values`.

    `times` is when each was heard since the start [ns], `clock` what /clock showed its listeners then,
    `stamps` those of their headers, or `clock` where there is none; `numbers` are by `paths` into each.
    """

    paths: Sequence[str] = ()
    times: list[int] = field(default_factory=list)
    clock: list[int] = field(default_factory=list)
    stamps: list[int] = field(default_factory=list)
    numbers: dict[str, list[list[float]]] = field(default_factory=dict)
    read: Read | None = None
    read_values: list[Any] = field(default_factory=list)

    def take(self, message: Any, time_ns: int, clock_ns: int) -> None:  # noqa: ANN401 - of any type
        """Takes a message.

        Args:
            message: As rclpy or rosbags gives it; its bytes where only that it came is asked for.
            time_ns: When it was heard, since the start.
            clock_ns: What the clock of the listeners shows then.
        """
        self.times.append(time_ns)
        self.clock.append(clock_ns)
        self.stamps.append(stamp_ns(message) if hasattr(message, "header") else clock_ns)
        if self.read is not None:
            self.read_values += self.read(message)
        for path in self.paths:
            self.numbers.setdefault(path, []).append(numbers_at(message, path))


def readers(names: Iterable[str]) -> dict[str, Reader]:
    """Returns the Reader of each topic of which these quantities need something."""
    readers: dict[str, Reader] = {}
    for name in names:
        if (pose := heard_quantity(name, POSE)) is not None:
            readers |= dict.fromkeys(pose.topics, Reader(poses.TYPES, poses.rows_of))
        if (grid := heard_quantity(name, MAP)) is not None:
            readers[grid.topic] = Reader(maps.TYPES, maps.grids_of)
    return readers


def heard_series(
    case: Case, heard: Mapping[str, Arrivals], known: Iterable[str], path: poses.TruePath, end_ns: int
) -> dict[str, Series]:
    """Returns the quantities of topics over time of which a scenario expects or measures something.

    Args:
        case: The run.
        heard: What has arrived on each topic.
        known: All topics that somebody publishes.
        path: The true poses.
        end_ns: When the run ended, since its start.
    """
    series: dict[str, Series] = {}
    read = {topic: arrivals.read_values for topic, arrivals in heard.items()}
    for name in case.scenario.quantities:
        if (pose := heard_quantity(name, POSE)) is not None:
            series[name] = poses.pose_series(pose, read, path)
        if (grid := heard_quantity(name, MAP)) is not None:
            truth = graded_world(case.run)  # kept
            series[name] = maps.map_series(grid, read.get(grid.topic, ()), truth)
    for name, bound in case.scenario.measured:
        if (quantity := heard_quantity(name)) is not None:
            series[bound.label(name)] = topic_series(quantity, bound.of, heard, known, end_ns)
    return series


def topic_series(
    quantity: HeardQuantity,
    of: str | None,
    heard: Mapping[str, Arrivals],
    known: Iterable[str],
    end_ns: int,
) -> Series:
    """Returns a quantity over time; where the topic did not exist, without any value, and why.

    Args:
        quantity: Of a topic.
        of: The topic of the input, of a latency.
        heard: Of each topic that somebody has published and that is expected something of.
        known: All topics that somebody publishes.
        end_ns: When the run ended, since its start.
    """
    for topic in filter(None, (quantity.topic, of)):
        if topic not in heard:
            return Series(np.empty(0), np.empty(0), nothing=unknown("topic", topic, known))
    own = heard[quantity.topic]
    times = np.array(own.times)
    nothing = f"nothing was heard on {quantity.topic}" if not len(times) else "there is no value"
    unit, _ = OF_TOPICS.get(quantity.measure, ("", ""))
    match quantity.measure:
        case "count":
            return Series(times / NANOSECONDS, np.ones(len(times)), is_tally=True)
        case "rate":
            return _rate(times, end_ns)
        case "age":
            values = (np.array(own.clock) - np.array(own.stamps)) / NANOSECONDS
        case "latency":
            values = _latency(own, heard[of or ""])
            if len(times):
                nothing = f"nothing was heard on {of} before {quantity.topic}"
        case path:
            numbers = own.numbers.get(path, [])
            times = np.repeat(times, np.array([len(some) for some in numbers], dtype=np.intp))
            values = np.array([value for some in numbers for value in some])
    return Series(times / NANOSECONDS, values, unit, nothing)


def _rate(times: Integers, end_ns: int) -> Series:
    """Messages in the second up to each 50 ms, from the first whole second on."""
    ends = np.arange(NANOSECONDS, end_ns + 1, SAMPLED_NS, dtype=np.int64)
    ordered = np.searchsorted(times, ends, side="right")
    counts = ordered - np.searchsorted(times, ends - NANOSECONDS, side="right")
    return Series(ends / NANOSECONDS, counts.astype(float), "Hz")


def _latency(output: Arrivals, source: Arrivals) -> NDArray[np.float64]:
    """The time from the stamp of the newest input heard by then to each output [s]."""
    newest = np.searchsorted(np.array(source.times), np.array(output.times), side="right") - 1
    values = np.full(len(output.times), np.nan)
    known = newest >= 0
    clock, stamps = np.array(output.clock), np.array(source.stamps)
    values[known] = (clock[known] - stamps[newest[known]]) / NANOSECONDS
    return values
