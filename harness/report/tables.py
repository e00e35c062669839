"""The report's tables as rows of text: metrics against truth, and the manifest."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.base.sim_time import NANOSECONDS
from harness.episode.result import RunResult
from harness.page.figure import DASH, MINUS, TIMES, spelled
from harness.report.encounters import Encounter
from harness.report.log import Log, describe, meetings
from harness.report.recorder import Stretch
from harness.world.actors.actor import Actor
from rover_metrics.analysis.social.metrics import PERSONAL_SPACE

MOST_CONTACTS = 50
DOING = {"hazard": "hits", "rock": "on", "scrape": "scrapes"}
UNITS = {"duration": "s", "timestep": "s", "imu_rate": "Hz", "map_size": "m"}  # of the manifest


@dataclass(frozen=True, slots=True)
class Comparison:
    """What the metrics say about a quantity and what the simulator knows, as text with units."""

    quantity: str
    metric: str = DASH
    truth: str = DASH
    difference: str = DASH


def comparisons(result: RunResult, log: Log) -> list[Comparison]:
    """Returns the metrics of a run against its truth."""
    truth, row = result.truth, result.last_row or {}
    threshold = result.thresholds.collision_threshold
    clearances = [value for value in log.columns.get("Obstacle Clearance", []) if math.isfinite(value)]
    mean_speed = float(np.mean(log.columns.get("Current Velocity") or math.nan))
    rough = log.columns.get("Is Rough Terrain", [])
    tipped = ", tipped over" if truth.tipped_over else ""
    return [
        _compared("Distance", "m", row.get("Distance Traveled"), truth.path_length),
        _compared("Mean speed", "m/s", mean_speed, result.mean_speed),
        Comparison(
            "Collisions",
            f"{row['Total Collisions']} scans below {threshold:g} m" if row else DASH,
            f"{truth.hazard_contacts} contacts with hazards, {truth.hazard_contact_s:.2f} s",
        ),
        Comparison("Smallest clearance logged", f"{min(clearances):.2f} m" if clearances else DASH),
        Comparison("Rough terrain", f"{sum(rough):.0f} of {len(rough)} rows" if rough else DASH),
        Comparison("Wheel slip, mean of moving wheels", truth=f"{truth.mean_slip:.2f}"),
        Comparison("On rocks", truth=f"{truth.rock_contacts} contacts, {truth.rock_contact_s:.2f} s"),
        Comparison("Body scraping the ground", truth=f"{truth.scrapes} times, {truth.scrape_s:.2f} s"),
        Comparison("Largest tilt", truth=f"{math.degrees(truth.largest_tilt):.0f}°{tipped}"),
    ]


def people(track: Sequence[Stretch]) -> list[Comparison]:
    """Returns how near people were; nothing of a run without any."""
    nearest = min((stretch.nearest_person for stretch in track), default=math.inf)
    if math.isinf(nearest):
        return []
    near = f"People within {PERSONAL_SPACE:g} m"
    return [
        Comparison(near, truth=f"{len(meetings(track))} times"),
        Comparison("Nearest person", truth=f"{nearest:.2f} m"),
    ]


def encounter_rows(met: Sequence[Encounter], actors: Sequence[Actor]) -> list[tuple[str, ...]]:
    """Returns encounters as text: number, who, distance, when, how long near, both places."""
    return [
        (
            str(number),
            actors[one.person].name,
            f"{one.nearest.distance:.2f} m",
            f"{one.nearest.time_s:.1f} s",
            f"{one.near_s:.1f} s" if one.near_s else DASH,
            _place(one.nearest.rover),
            _place(one.nearest.person),
        )
        for number, one in enumerate(met, 1)
    ]


def _place(place: tuple[float, float]) -> str:
    return ", ".join(f"{value:.1f}".replace("-", MINUS) for value in place)


def contact_rows(result: RunResult) -> list[tuple[str, str, str, str]]:
    """Returns the first MOST_CONTACTS contacts as text: what with what, start, length, peak force."""
    return [
        (
            f"{event.part} {DOING[event.kind]} {event.other}",
            f"{event.start_ns / NANOSECONDS:.2f} s",
            f"{(event.end_ns - event.start_ns) / NANOSECONDS:.2f} s",
            f"{event.force:.0f} N",
        )
        for event in result.along.events[:MOST_CONTACTS]
    ]


def steady_text(name: str, values: Sequence[float]) -> str:
    """Returns the one value that a column has, and in how many of its rows if not in all."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return "empty"
    text = f"{known[0]:g} {spelled(describe(name).unit)}".rstrip()
    return text if len(known) == len(values) else f"{text} in {len(known)} of {len(values)} rows"


def key_figures(result: RunResult) -> list[tuple[str, str]]:
    """Returns what a reader wants to know first, as pairs of name and text."""
    truth = result.truth
    return [
        ("simulated time", f"{result.simulated_s:.1f} s"),
        ("true path", f"{truth.path_length:.1f} m"),
        ("hazard contacts", str(truth.hazard_contacts)),
        ("largest tilt", f"{math.degrees(truth.largest_tilt):.0f}°"),
        ("mean slip of moving wheels", f"{truth.mean_slip:.2f}"),
        ("messages lost", f"{result.lost} of {result.messages:,}"),
        ("simulation speed", f"{result.real_time_factor:.1f}{TIMES} real time"),
    ]


def facts(values: Mapping[str, object], *, prefix: str = "") -> list[tuple[str, str]]:
    """Returns nested values as flat pairs of name and text."""
    pairs: list[tuple[str, str]] = []
    for name, value in values.items():
        if isinstance(value, Mapping):
            pairs += facts(value, prefix=f"{prefix}{name}.")
        else:
            unit = f" {UNITS[name]}" if name in UNITS else ""
            pairs.append((f"{prefix}{name}", _text(value) + unit))
    return pairs


def _compared(quantity: str, unit: str, metric: float | str | None, truth: float) -> Comparison:
    if not isinstance(metric, int | float) or not math.isfinite(metric):
        return Comparison(quantity, truth=f"{truth:.2f} {unit}")
    difference = DASH
    if truth > 0.0:
        percent = round(100.0 * ((metric - truth) / truth), 1)
        difference = f"{percent:+} %".replace("-", MINUS) if percent else "0.0 %"
    return Comparison(quantity, f"{metric:.2f} {unit}", f"{truth:.2f} {unit}", difference)


def _text(value: object) -> str:
    if value is None:
        return DASH
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return ", ".join(map(_text, value)) or DASH
    return f"{value:g}" if isinstance(value, float) else str(value)
