"""The tables of a report: metrics against truth, people, contacts, messages, and the manifest."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from harness.base.errors import how_many
from harness.base.sim_time import NANOSECONDS
from harness.episode.result import RunResult
from harness.page.figure import DASH, MINUS, TIMES, Plot
from harness.page.run.encounters import Encounter
from harness.page.run.log import Log, describe, meetings
from harness.page.run.recorder import Stretch
from harness.world.actors.actor import Actor
from rover_metrics.analysis.social.metrics import PERSONAL_SPACE
from rover_metrics.sheet.sheet import Sheet, spelled, unbroken

MOST_CONTACTS = 50
DOING = {"hazard": "hits", "rock": "on", "scrape": "scrapes"}
UNITS = {"duration": "s", "timestep": "s", "imu_rate": "Hz", "map_size": "m"}  # of the manifest


def comparisons(result: RunResult, log: Log, track: Sequence[Stretch]) -> Sheet:
    """Returns the metrics of a run beside its truth.

    Args:
        result: Has the truth.
        log: Has the metrics; may be empty.
        track: Has the people.
    """
    truth, row = result.truth, result.last_row or {}
    threshold = result.thresholds.collision_threshold
    clearances = [value for value in log.columns.get("Obstacle Clearance", []) if math.isfinite(value)]
    mean_speed = float(np.mean(log.columns.get("Current Velocity") or math.nan))
    rough = log.columns.get("Is Rough Terrain", [])
    collisions = f"{row['Total Collisions']} scans below {threshold:g} m" if row else DASH
    hits = f"{truth.hazard_contacts} contacts with hazards, {truth.hazard_contact_s:.2f} s"
    tipped = ", tipped over" if truth.tipped_over else ""
    mission = [] if result.along.mission is None else result.along.mission.rows()
    rows = (
        _compared("Distance", "m", row.get("Distance Traveled"), truth.path_length),
        _compared("Mean speed", "m/s", mean_speed, result.mean_speed),
        ("Collisions", collisions, hits),
        ("Smallest clearance logged", f"{min(clearances):.2f} m" if clearances else DASH),
        ("Rough terrain", f"{sum(rough):.0f} of {len(rough)} rows" if rough else DASH),
        ("Wheel slip, mean of moving wheels", DASH, f"{truth.mean_slip:.2f}"),
        ("On rocks", DASH, f"{how_many(truth.rock_contacts, 'contact')}, {truth.rock_contact_s:.2f} s"),
        ("Body scraping the ground", DASH, f"{how_many(truth.scrapes, 'time')}, {truth.scrape_s:.2f} s"),
        ("Largest tilt", DASH, f"{math.degrees(truth.largest_tilt):.0f}°{tipped}"),
        *((kind.capitalize(), DASH, words) for kind, words in mission),
        *_people(track),
    )
    titles = ("Quantity", "metrics_node", "Truth", "Diff.")
    return Sheet(titles, tuple((*cells, DASH, DASH)[: len(titles)] for cells in rows))


def _people(track: Sequence[Stretch]) -> list[tuple[str, ...]]:
    """How near people were; no rows of a run without any."""
    if math.isinf(nearest := min((stretch.nearest_person for stretch in track), default=math.inf)):
        return []
    return [
        (f"People within {PERSONAL_SPACE:g} m", DASH, f"{len(meetings(track))} times"),
        ("Nearest person", DASH, f"{nearest:.2f} m"),
    ]


def encounter_table(met: Sequence[Encounter], actors: Sequence[Actor]) -> Sheet:
    """Returns encounters in the order of their numbers on the map."""
    return Sheet.of(
        {
            "No.": str(number),
            "Person": actors[one.person].name,
            "Distance": f"{one.nearest.distance:.2f} m",
            "At": f"{one.nearest.time_s:.1f} s",
            "Near for": f"{one.near_s:.1f} s" if one.near_s else DASH,
            "Rover x, y [m]": _place(one.nearest.rover),
            "Person x, y [m]": _place(one.nearest.person),
        }
        for number, one in enumerate(met, 1)
    )


def _place(place: tuple[float, float]) -> str:
    return ", ".join(f"{value:.1f}".replace("-", MINUS) for value in place)


def contact_table(result: RunResult) -> Sheet:
    """Returns the first MOST_CONTACTS contacts: what touched what, start, length, peak force."""
    return Sheet.of(
        {
            "Contact": f"{event.part} {DOING[event.kind]} {event.other}",
            "From": f"{event.start_ns / NANOSECONDS:.2f} s",
            "For": f"{(event.end_ns - event.start_ns) / NANOSECONDS:.2f} s",
            "Peak force": f"{event.force:.0f} N",
        }
        for event in result.along.events[:MOST_CONTACTS]
    )


def message_table(result: RunResult) -> Sheet:
    """Returns how many messages of each topic were published, received and lost."""
    return Sheet.of(
        {
            "Topic": topic,
            "Published": f"{count.published:,}",
            "Received": DASH if count.received is None else f"{count.received:,}",
            "Lost": DASH if count.received is None else f"{count.lost:,}",
        }
        for topic, count in result.topics.items()
    )


def steady_table(log: Log, plots: Sequence[Plot]) -> Sheet:
    """Returns the columns of a log, by their plots, that have one value all along."""
    return Sheet.of(
        {
            "Column": plot.heading,
            "Value": steady_text(plot.heading, log.columns[plot.heading]),
            "Meaning": plot.caption,
        }
        for plot in plots
    )


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


def _compared(
    quantity: str, unit: str, metric: float | str | None, truth: float
) -> tuple[str, str, str, str]:
    if not isinstance(metric, int | float) or not math.isfinite(metric):
        return quantity, DASH, f"{truth:.2f} {unit}", DASH
    difference = DASH
    if truth >= 0.005:  # less is shown as 0
        percent = round(100.0 * ((metric - truth) / truth), 1)
        difference = unbroken(f"{percent:+} %".replace("-", MINUS) if percent else "0.0 %")
    return quantity, f"{metric:.2f} {unit}", f"{truth:.2f} {unit}", difference


def _text(value: object) -> str:
    if value is None or value == "":
        return DASH
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Mapping):  # of a list: what is said of it
        said = (f"{name} {_text(part)}" for name, part in value.items() if part not in (None, ""))
        return "; ".join(said)
    if isinstance(value, list | tuple):
        return ", ".join(map(_text, value)) or DASH
    return f"{value:g}" if isinstance(value, float) else str(value)
