"""The page about a run: the names of the template's variables are the keys here."""

import math
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from types import MappingProxyType

import numpy as np

from harness.episode.assembly import gravity as gravity_of
from harness.episode.assembly import world_of
from harness.episode.manifest import manifest
from harness.episode.mishaps import mishaps
from harness.episode.result import RunResult
from harness.page.figure import MINUS, TIMES, Plot
from harness.page.run import tables
from harness.page.run.encounters import NEAR, encounters
from harness.page.run.hillshade import shade
from harness.page.run.log import Log, caption, collisions, contacts, describe, meetings, read_log
from harness.page.run.recorder import RunRecorder, Stretch
from harness.page.run.series import MOST_ROWS, series_figure, varies
from harness.page.run.soil import soil_plots
from harness.page.run.terrain_map import map_figure
from harness.page.shell import fill
from harness.robots import find_rover, robot_name
from harness.robots.lidar import scan_points

NO_OTHERS: Mapping[str, Sequence[Stretch]] = MappingProxyType({})
LISTED = ("arguments", "versions", "world")  # parts of the manifest that are tables of their own


def _map(
    result: RunResult, recorder: RunRecorder, log: Log, others: Mapping[str, Sequence[Stretch]]
) -> Plot:
    run, track = result.run, recorder.track
    world = world_of(run)
    hillshade, heights = shade(world.ground), world.ground.heights
    half_x, half_y = world.ground.half_size
    x, y, yaw = map(_signed, world.start if result.info is None else result.info.start)
    middle = world.ground.middle
    origin = (
        f"the file's, the middle is at {', '.join(map(_signed, middle))}"
        if any(middle)
        else "the middle"
    )
    collided, near = collisions(log, track), meetings(track)
    placed, rover = recorder.last_scan, find_rover(result.rover.robot)
    figure = map_figure(
        world,
        hillshade,
        track,
        collisions=collided,
        others=others,
        scan=np.empty((0, 2)) if placed is None else scan_points(placed, rover),
        gravity=gravity_of(run),
    )
    summary = (
        f"Path of {result.truth.path_length:.1f} m with {len(collided)} places where the metrics "
        f"counted collisions and {len(contacts(track))} where the rover touched a hazard."
        + (f" People were near {len(near)} times." if world.people else "")
    )
    caption = (
        f"{2 * half_x:g} m {TIMES} {2 * half_y:g} m, heights {_signed(heights.min())} to "
        f"{_signed(heights.max())} m. +x is right and +y is up (a heightmap's first row is on top), "
        f"the origin is {origin}; the rover starts at x {x} m, y {y} m, heading {yaw} "
        "rad from +x towards +y. Lit from the north-west, up being north, with slopes "
        f"{hillshade.exaggeration:.1f} times as steep. A point of the path is the largest "
        f"||a| {MINUS} g| within {recorder.stretch_s:g} s; outlines include what is below the ground."
    )
    return Plot("map", summary, figure, "Map", caption)


def _signed(value: float) -> str:
    return f"{value:.2f}".replace("-", MINUS)


def _series(result: RunResult, recorder: RunRecorder, log: Log) -> list[Plot]:
    track = recorder.track
    touched, gravity = contacts(track), gravity_of(result.run)
    figures = {
        name: series_figure(name, log, result.thresholds, track, touched, gravity)
        for name in log.columns
    }
    return [
        Plot(f"series-{number}", _summary(name, log.columns[name]), figure, name, caption(name))
        for number, (name, figure) in enumerate(figures.items())
    ]


def _summary(name: str, values: list[float]) -> str:
    finite = [value for value in values if math.isfinite(value)]
    if not finite:
        return f"{name} over time: no finite value"
    unit = describe(name).unit
    return f"{name} over time: from {min(finite):g} to {max(finite):g} {unit}, at last {finite[-1]:g}"


def render(
    result: RunResult, recorder: RunRecorder, others: Mapping[str, Sequence[Stretch]] = NO_OTHERS
) -> str:
    """Returns the HTML of a run's report.

    Args:
        result: What the run came to.
        recorder: Watched the rover.
        others: Paths of further rovers in the same world, by name.
    """
    log, values, rover = read_log(result.log_path), manifest(result), result.rover
    robot = robot_name(rover.robot)
    called = f"{rover.name}, a {robot}," if rover.name else robot
    terrain_map, plots = _map(result, recorder, log, others), _series(result, recorder, log)
    met = encounters(recorder.track)
    soil = soil_plots(recorder.track, find_rover(rover.robot).wheel_names)
    series = [plot for plot in plots if varies(plot.figure, log.columns[plot.heading])]
    steady = [plot for plot in plots if plot not in series]
    content: dict[str, object] = {
        "result": result,
        "heading": f"{called} on {Path(result.run.world.terrain).name}",
        "arguments": values["arguments"],
        "outcome": values["outcome"],
        "mishaps": mishaps(result),
        "written": datetime.now().astimezone().isoformat(sep=" ", timespec="seconds"),
        "key_figures": tables.key_figures(result),
        "map": terrain_map,
        "comparisons": tables.comparisons(result, log, recorder.track),
        "encounters": tables.encounter_table(met, world_of(result.run).people),
        "near": NEAR,
        "contacts": tables.contact_table(result),
        "messages": tables.message_table(result),
        "series": [*series, *soil],
        "steady": tables.steady_table(log, steady),
        "notes": log.notes,
        "thinned_to": MOST_ROWS if len(log.time_s) > MOST_ROWS else None,
        "facts": {name: tables.facts(values[name] or {}) for name in LISTED},
    }
    return fill("report", content, "harness.page.run", [terrain_map, *series, *soil])
