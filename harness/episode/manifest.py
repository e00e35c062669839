"""The JSON that stands beside a run's CSV: everything needed to repeat, judge and believe it."""

import json
import platform
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from harness.base.errors import UsageError
from harness.base.files import write_whole
from harness.base.sim_time import NANOSECONDS
from harness.base.version import __version__
from harness.drivers import DRIVERS
from harness.episode.mission import MissionOutcome
from harness.episode.result import RunResult
from harness.faults.kinds import FAULTS
from harness.robots import IDEAL, find_rover
from harness.samples import ContactEvent
from harness.sensors.table import OPTIONAL
from harness.soil.soils import SOILS
from harness.spec.rover import RoverSetup
from harness.world.files import is_terrain_file
from harness.world.terrains import TERRAINS
from rover_metrics.extended.further import FURTHER
from rover_metrics.log.files import json_safe
from rover_metrics.plugins import Table

FLAT_LIST = re.compile(r"\[[^\[\]{}\"]+\]")  # of numbers: one line for each is too much
# Options that stand in the manifest only where they are given.
RARE = ("targets", "route", "drivers", "aborts", "resumes", "link_losses", "keep_ruts")
PACKAGES = ("mujoco", "numpy", "numba", "ros-rclpy")


def manifest(result: RunResult) -> dict[str, Any]:
    """Returns the run as JSON values; infinite numbers become null."""
    values: dict[str, Any] = json_safe(
        {
            "arguments": _arguments(result),
            "command": result.command or None,
            "mode": result.mode,
            "versions": dict(_versions()),
            "world": None if result.info is None else _stated(asdict(result.info)),
            "outcome": _outcome(result),
            "simulated_s": result.simulated_s,
            "wall_s": result.wall_s,
            "paused_s": result.paused_s,
            "waited_s": result.waited_s,
            "real_time_factor": result.real_time_factor,
            "first_row_s": result.first_row_s,
            "topics": {topic: asdict(count) for topic, count in result.topics.items()},
            "lost": result.lost,
            "commands": asdict(result.commands),
            "rows": result.rows,
            "log": None if result.log_path is None else str(result.log_path),
            "last_row": result.last_row,
            "thresholds": asdict(result.thresholds),
            "params": None if result.params is None else str(result.params),
            # What the metrics node says of its session, as it would in a record of its own.
            "node": None
            if result.reception is None
            else {"segments": result.segments, "topics": result.reception},
            "recording": None if result.recording is None else str(result.recording),
            "social_log": None if result.social_log is None else str(result.social_log),
            "report": None if result.report is None else str(result.report),
            "truth": _truth(result),
        }
    )
    plugins = _plugins_of(result)
    return values | ({"plugins": plugins} if plugins else {})


def write_manifest(result: RunResult, path: Path) -> None:
    """Writes the manifest, there whole or not at all; a UsageError says that it cannot be written."""
    text = json.dumps(manifest(result), indent=2, allow_nan=False) + "\n"
    text = FLAT_LIST.sub(lambda match: re.sub(r"\s+", " ", match[0]), text)
    write_whole(path, text, "the summary", UsageError)


def _arguments(result: RunResult) -> dict[str, Any]:
    """What repeats the run; a terrain from a file has no difficulty."""
    run, number = result.run, result.number
    arguments = run.fields(number)
    if is_terrain_file(run.world.terrain):
        del arguments["difficulty"]
    world_robot = run.rover.robot if result.rover.name else ""
    return _stated(arguments) | {"number": number, "world_robot": world_robot}


def _stated(values: dict[str, Any]) -> dict[str, Any]:
    """Values without the rare ones that nobody gave, and without the usual motors."""
    usual = dict.fromkeys(RARE, None) | {"actuators": IDEAL, "surface": None}
    return {n: value for n, value in values.items() if n not in usual or (value or None) != usual[n]}


def _outcome(result: RunResult) -> dict[str, str | None]:
    if result.failure is not None:
        return {"status": "failed", "reason": result.failure}
    if result.interrupted is not None:
        return {"status": "interrupted", "reason": result.interrupted}
    if result.lost:
        return {"status": "failed", "reason": f"{result.lost} messages lost"}
    return {"status": "complete", "reason": None}


def _truth(result: RunResult) -> dict[str, Any]:
    truth, along = asdict(result.truth), result.along
    truth["time_s"] = truth.pop("time_ns") / NANOSECONDS
    mission = {} if along.mission is None else {"mission": _mission(along.mission)}
    return truth | {
        "mean_speed": result.mean_speed,
        "roughness": {"p50": along.roughness_p50, "p95": along.roughness_p95},
        "event_count": along.event_count,
        "events": [_event(event) for event in along.events],
        "path_period_s": along.path_period_s,
        "path": along.path,
        **mission,
    }


def _mission(mission: MissionOutcome) -> dict[str, Any]:
    points = [{"name": p.name, "place": p.place, "reached_s": p.reached_s} for p in mission.way_points]
    return {"way_points": points, "targets": [one._asdict() for one in mission.targets]}


def _event(event: ContactEvent) -> dict[str, Any]:
    return {
        "kind": event.kind,
        "start_s": event.start_ns / NANOSECONDS,
        "end_s": event.end_ns / NANOSECONDS,
        "part": event.part,
        "other": event.other,
        "force_n": event.force,
        "point": event.point,
    }


@cache
def _versions() -> dict[str, str | None]:
    own = {"rover-harness": __version__, "python": platform.python_version()}
    installed: dict[str, str | None] = dict.fromkeys(PACKAGES)
    for package in PACKAGES:
        with suppress(PackageNotFoundError):
            installed[package] = version(package)
    return own | installed


def _plugins_of(result: RunResult) -> dict[str, dict[str, str]]:
    """By "TABLE NAME", where each plug-in of a rover's part of a run is from, and its hash."""
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
