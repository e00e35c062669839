"""Tables of scores with their intervals."""

import math

from harness.page.figure import DASH, MINUS
from harness.tuning.episodes.plan import Part
from harness.tuning.page.layout import Table
from harness.tuning.page.traces import chosen, spelled
from harness.tuning.scoring.collision import CollisionStudy, DetectorStudy
from harness.tuning.scoring.estimate import Estimate
from harness.tuning.scoring.ground import GroundStudy
from harness.tuning.scoring.result import Candidate, Verdict
from harness.tuning.scoring.study import RobotStudy

CHECKING, CHOOSING = Part.CHECKING, Part.CHOOSING
NOTHING = DASH


def thresholds(study: RobotStudy) -> Table:
    """Every threshold by the measure that judges it."""
    head = ("Threshold", "Score", *_heads("default"), *_heads("tuned"), "gain", "verdict")
    return Table(head, tuple(_threshold(verdict) for verdict in study.verdicts))


def _threshold(verdict: Verdict) -> tuple[str, ...]:
    gain = verdict.gain.get(verdict.measure)
    return (
        verdict.name,
        verdict.measure,
        f"{verdict.default.value:g} {spelled(verdict.unit)}",
        *_parts(verdict.default, verdict.measure),
        NOTHING if verdict.tuned is None else f"{verdict.tuned.value:g} {spelled(verdict.unit)}",
        *_parts(verdict.tuned, verdict.measure),
        NOTHING if gain is None else text(gain, sign="+"),
        _standing(verdict),
    )


def _heads(name: str) -> tuple[str, str, str]:
    return name, f"{name}, choosing", f"{name}, checking"


def _standing(verdict: Verdict) -> str:
    """Whether the tuned value is better, in a few words."""
    if verdict.tuned is None:
        return f"default stays: {verdict.lack}"
    if verdict.value is None:
        return "default stays: nothing better is proven"
    return "better: intervals apart" if verdict.is_proven else "better on the same episodes"


def measures(verdict: Verdict) -> Table:
    """Every measure of one threshold."""
    values = [f"default {verdict.default.value:g}"]
    candidates = [verdict.default]
    if verdict.tuned is not None:
        values.append(f"{chosen(verdict)} {verdict.tuned.value:g}")
        candidates.append(verdict.tuned)
    head = ("Measure", *(f"{value}, {part}" for value in values for part in Part))
    rows = tuple(
        (name, *(text(candidate.scores[part][name]) for candidate in candidates for part in Part))
        for name in verdict.default.scores[CHECKING]
    )
    if verdict.tuned is None:
        return Table(head, rows)
    gains = tuple((*row, text(verdict.gain[row[0]], sign="+")) for row in rows)
    return Table((*head, "gain, checking"), gains)


def detectors(study: CollisionStudy) -> Table:
    """What each detector comes to on the checking episodes."""
    head = (
        "Detector",
        "below",
        "F1",
        "precision",
        "recall",
        "false alarms per km",
        "median lead",
        "F1 of single scans",
    )
    told = (("default: ", study.default), *(("", detector) for detector in study.detectors))
    return Table(head, tuple(_detector(prefix, detector) for prefix, detector in told))


def _detector(prefix: str, told: DetectorStudy) -> tuple[str, ...]:
    scores = told.events.scores[CHECKING]
    return (
        prefix + told.name,
        _together(f"{told.events.value:g} m"),
        *(text(scores[name]) for name in ("F1", "precision", "recall")),
        text(scores["false alarms per km"], 1),
        NOTHING if told.lead_s is None else f"{told.lead_s:.2f} s",
        text(told.scans["F1"]),
    )


def zones(study: CollisionStudy) -> Table:
    """Which contacts are told, by side; those that nothing can tell are a line of their own."""
    names = list(study.zones[0].found) if study.zones else []
    values = {"default": study.default.events.value} | {
        told.name: told.events.value for told in study.detectors
    }
    head = ("Contact", "number", *(f"{name}, {values[name]:g} m" for name in names))
    rows = [
        (
            f"{row.zone}, seen",
            str(row.contacts),
            *(_share(row.found[name], row.contacts) for name in names),
        )
        for row in study.zones
    ]
    blind = [(f"not seen: {spot.sight}", str(spot.contacts)) for spot in study.blind_spots]
    return Table(head, (*rows, *blind))


def speeds(study: GroundStudy) -> Table:
    """How the best value and the separation shift with speed, over all episodes."""
    head = ("Speed", "values", "rough", "AUC", "best value")
    unit = spelled(study.verdict.unit)
    rows = tuple(
        (
            f"{at.speeds[0]:g} to {at.speeds[1]:g} m/s",
            str(at.windows),
            str(at.rough),
            NOTHING if at.auc is None else f"{at.auc:.2f}",
            NOTHING if at.best is None else f"{at.best:g} {unit}",
        )
        for at in study.speed_bins
    )
    return Table(head, rows)


def clearance(study: RobotStudy) -> Table:
    """The sum that makes the safe clearance."""
    parts, verdict = study.clearance, study.clearance.verdict
    stop = parts.braking
    driven_on = stop.stopping_distance - stop.distance
    rows = [
        ("from the lidar to the front end", f"{parts.overhang:.3f} m"),
        (f"driven at {stop.speed:.2f} m/s before a command answers a scan", f"{driven_on:.3f} m"),
        (f"braking from there, measured ({stop.time:.2f} s)", f"{stop.distance:.3f} m"),
        ("margin", f"{parts.margin:.3f} m"),
        ("sum", f"{parts.overhang + stop.stopping_distance + parts.margin:.3f} m"),
    ]
    if verdict.tuned is not None:
        rows.append(("rounded up", f"{verdict.tuned.value:g} m"))
    rows.append(("default", f"{verdict.default.value:g} m"))
    return Table(("Part", "length"), tuple(rows))


def driven(study: RobotStudy) -> Table:
    """What was driven."""
    what = study.driven
    rows = [(f"episodes: {ending}", str(number)) for ending, number in sorted(what.endings.items())]
    rows += [
        ("scored time", f"{what.seconds:.0f} s"),
        ("scored path", f"{what.path_length / 1000:.3f} km"),
        ("contacts with hazards, checking", str(study.collision.contacts)),
    ]
    return Table(("What", "how much"), tuple(rows))


def text(score: Estimate, digits: int = 2, sign: str = "") -> str:
    """A score with its interval, short enough for a cell."""
    if math.isnan(score.value):
        return NOTHING
    value = _number(score.value, digits, sign)
    if score.low is None or score.high is None:
        return f"{value} {_together('(no interval)')}"
    interval = f"({_number(score.low, digits, sign)} to {_number(score.high, digits, sign)})"
    return f"{value} {_together(interval)}"


def _number(value: float, digits: int, sign: str) -> str:
    return f"{value:{sign}.{digits}f}".replace("-", MINUS)


def _parts(candidate: Candidate | None, measure: str) -> tuple[str, str]:
    if candidate is None:
        return NOTHING, NOTHING
    return text(candidate.scores[CHOOSING][measure]), text(candidate.scores[CHECKING][measure])


def _share(part: int, whole: int) -> str:
    return _together(f"{part} ({100 * part / whole:.0f} %)") if whole else str(part)


def _together(words: str) -> str:
    """Words that stay on one line."""
    return words.replace(" ", "\N{NO-BREAK SPACE}")
