"""Messages that the truth judges: estimated poses and maps."""

from collections.abc import Iterable, Mapping
from typing import Any

from harness.episode.assembly import graded_world
from harness.scenario import maps, poses
from harness.scenario.arrivals import Reader
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


def judged_series(case: Case, read: Mapping[str, Any], path: poses.TruePath) -> dict[str, Series]:
    """Returns the quantities of poses and maps that a scenario expects something of.

    Args:
        case: The run.
        read: What was taken out of the messages of each topic, in the order of their arrival.
        path: The true poses.
    """
    series: dict[str, Series] = {}
    for name in case.scenario.quantities:
        if (pose := heard_quantity(name, POSE)) is not None:
            series[name] = poses.pose_series(pose, read, path)
        if (grid := heard_quantity(name, MAP)) is not None:
            truth = graded_world(case.run)  # kept
            series[name] = maps.map_series(grid, read.get(grid.topic, ()), truth)
    return series
