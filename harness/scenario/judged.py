"""Quantities of topics: of their messages, and of the poses and maps in them, which the truth judges."""

from collections.abc import Iterable, Mapping

from harness.episode.assembly import graded_world
from harness.scenario import maps, poses
from harness.scenario.arrivals import Arrivals, Reader, topic_series
from harness.scenario.case import Case
from harness.scenario.names import MAP, POSE, heard_quantity
from harness.scenario.series import Series


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
