"""Which plug-ins a run is made of, with the hash of what they were: for its manifest."""

from collections.abc import Iterator
from typing import Any

from harness.drivers import DRIVERS
from harness.episode.result import RunResult
from harness.faults.kinds import FAULTS
from harness.robots import find_rover
from harness.sensors.table import OPTIONAL
from harness.soil.soils import SOILS
from harness.spec.rover import RoverSetup
from harness.world.terrains import TERRAINS
from rover_metrics.extended.further import FURTHER
from rover_metrics.plugins import Table


def plugins_of(result: RunResult) -> dict[str, dict[str, str]]:
    """Returns, by "TABLE NAME", where each plug-in of a rover's part of a run is from, and its hash."""
    plugins = {}
    for table, name in _asked(result):
        source = table.source(name) if name in table else None
        if source is not None:
            plugins[f"{table.name} {name}"] = {"from": source[0], "sha256": source[1]}
    return plugins


def _asked(result: RunResult) -> Iterator[tuple[Table[Any], str]]:
    world, rover = result.run.world, result.rover
    yield TERRAINS, world.terrain
    yield SOILS, world.soil
    yield DRIVERS, rover.driver
    yield from ((OPTIONAL, kind) for kind in _sensors(rover))
    yield from ((FAULTS, fault.kind) for fault in rover.faults)
    yield from ((FURTHER, name) for name in result.columns)


def _sensors(rover: RoverSetup) -> Iterator[str]:
    """The kinds of the optional sensors that a rover carries, those of its rover.yaml too."""
    listed = {
        str(each.get("name", each["kind"])): each["kind"] for each in find_rover(rover.robot).sensors
    }
    names = listed if rover.sensors is None else [choice.name for choice in rover.sensors]
    yield from (str(listed.get(name, name)) for name in names)
