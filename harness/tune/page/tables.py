"""Tables of scores with their intervals."""

import math

from harness.page.figure import DASH, MINUS
from harness.tune.episodes.plan import Part
from harness.tune.page.subject import chosen
from harness.tune.scoring.choose import Candidate, Verdict
from harness.tune.scoring.collision import CollisionStudy
from harness.tune.scoring.estimate import FEWEST_DIGITS, Estimate, digits_for
from harness.tune.scoring.ground import GroundStudy
from harness.tune.scoring.study import RobotStudy
from rover_metrics.sheet.sheet import Sheet, spelled, unbroken


def thresholds(study: RobotStudy) -> Sheet:
    """Returns every threshold with the measure that judges it."""
    heads = (f"{name}{part}" for name in ("default", "tuned") for part in ("", ", train", ", test"))
    rows = (
        (
            verdict.name,
            verdict.measure,
            *_candidate(verdict, verdict.default),
            *_candidate(verdict, verdict.tuned),
            score_text(verdict.gain[verdict.measure], verdict.digits, "+") if verdict.tuned else DASH,
            _standing(verdict),
        )
        for verdict in study.verdicts
    )
    return Sheet(("Threshold", "Score", *heads, "gain", "verdict"), tuple(rows))


def _candidate(verdict: Verdict, candidate: Candidate | None) -> tuple[str, str, str]:
    if candidate is None:
        return DASH, DASH, DASH
    train, test = (score_text(candidate.scores[part][verdict.measure], verdict.digits) for part in Part)
    return spelled(verdict.written(candidate)), train, test


def _standing(verdict: Verdict) -> str:
    """Whether the tuned value is better."""
    if verdict.tuned is None:
        return f"default stays: {verdict.lack}"
    if verdict.value is None:
        return "default stays: nothing better is proven"
    return "better: intervals apart" if verdict.is_proven else "better on the same episodes"


def measures(verdict: Verdict) -> Sheet:
    """Returns every measure of one threshold."""
    columns = {  # by what stands above it: scores and the sign of positive ones
        f"{name} {candidate.value:g}, {part}": (scores, "")
        for name, candidate in (("default", verdict.default), (chosen(verdict), verdict.tuned))
        if candidate is not None
        for part, scores in candidate.scores.items()
    }
    if verdict.tuned is not None:
        columns["gain, test"] = verdict.gain, "+"
    rows = (
        (name, *(score_text(scores[name], digits, sign) for scores, sign in columns.values()))
        for name in verdict.default.scores[Part.TEST]
        for digits in [digits_for(verdict.gain[name]) if verdict.gain else FEWEST_DIGITS]
    )
    return Sheet(("Measure", *columns), tuple(rows))


def detectors(study: CollisionStudy) -> Sheet:
    """Returns the scores of each detector on the test episodes."""
    measures = ("F1", "precision", "recall")
    head = ("Detector", "below", *measures, "false alarms per km", "median lead", "F1 of single scans")
    rows = (
        (
            prefix + scored.name,
            unbroken(f"{scored.events.value:g} m"),
            *(score_text(scored.events.scores[Part.TEST][name]) for name in measures),
            score_text(scored.events.scores[Part.TEST]["false alarms per km"], 1),
            DASH if scored.lead_s is None else f"{scored.lead_s:.2f} s",
            score_text(scored.scans["F1"]),
        )
        for prefix, scored in (("default: ", study.default), *(("", one) for one in study.detectors))
    )
    return Sheet(head, tuple(rows))


def zones(study: CollisionStudy) -> Sheet:
    """Returns how many contacts of each side are detected; rows of their own for the others."""
    values = {"default": study.default.events.value}
    values |= {one.name: one.events.value for one in study.detectors}
    names = [f"{name}, {value:g} m" for name, value in values.items()] if study.zones else []
    rows: list[tuple[str, ...]] = []
    for row in study.zones:
        of = row.contacts
        shares = (f"{n} ({100 * n / of:.0f} %)" if of else str(n) for n in row.detected.values())
        rows.append((f"{row.zone}, seen", str(of), *map(unbroken, shares)))
    rows += ((f"not seen: {one.sight}", str(one.contacts)) for one in study.unseen_contacts)
    return Sheet(("Contact", "number", *names), tuple(rows))


def speeds(study: GroundStudy) -> Sheet:
    """Returns how the best value and the separation shift with speed, over all episodes."""
    unit = spelled(study.verdict.unit)
    rows = (
        (
            f"{at.speeds[0]:g} to {at.speeds[1]:g} m/s",
            str(at.windows),
            str(at.rough),
            DASH if at.auc is None else f"{at.auc:.2f}",
            DASH if at.best is None else f"{at.best:g} {unit}",
        )
        for at in study.speed_bins
    )
    return Sheet(("Speed", "values", "rough", "AUC", "best value"), tuple(rows))


def clearance(study: RobotStudy) -> Sheet:
    """Returns the sum that makes the safe clearance."""
    parts, verdict, stop = study.clearance, study.clearance.verdict, study.clearance.braking
    driven_on = stop.stopping_distance - stop.distance
    lengths = (
        ("from the lidar to the front end", parts.overhang),
        (f"driven at {stop.speed:.2f} m/s before a command answers a scan", driven_on),
        (f"braking from there, measured ({stop.time:.2f} s)", stop.distance),
        ("margin", parts.margin),
        ("sum", parts.overhang + stop.stopping_distance + parts.margin),
    )
    rounded = [] if verdict.tuned is None else [("rounded up", f"{verdict.tuned.value:g} m")]
    rows = [(name, f"{length:.3f} m") for name, length in lengths]
    default = ("default", f"{verdict.default.value:g} m")
    return Sheet(("Part", "length"), (*rows, *rounded, default))


def driven(study: RobotStudy) -> Sheet:
    """Returns what was driven."""
    driven = study.driven
    rows = (
        *((f"episodes: {ending}", str(number)) for ending, number in sorted(driven.endings.items())),
        ("scored time", f"{driven.seconds:.0f} s"),
        ("scored path", f"{driven.path_length / 1000:.3f} km"),
        ("contacts with hazards, test", str(study.collision.contacts)),
    )
    return Sheet(("What", "how much"), rows)


def score_text(score: Estimate, digits: int = FEWEST_DIGITS, sign: str = "") -> str:
    """Returns a score with its interval, short enough for a cell.

    Args:
        score: Any.
        digits: After the point.
        sign: "+" to write it before what is positive.
    """
    if math.isnan(score.value):
        return DASH
    value, low, high = (
        DASH if number is None else f"{number:{sign}.{digits}f}".replace("-", MINUS)
        for number in (score.value, score.low, score.high)
    )
    return f"{value} {unbroken('(no interval)' if score.low is None else f'({low} to {high})')}"
