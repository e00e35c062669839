"""The verdicts in sentences: which default is wrong for which rover, by how much, and why not."""

from collections.abc import Iterator

from harness.tuning.episodes.plan import Part
from harness.tuning.scoring.collision import CollisionStudy
from harness.tuning.scoring.result import Verdict
from harness.tuning.scoring.study import RobotStudy

TEST = Part.TEST
MATERIAL = 0.05  # of a score: a smaller difference is real, but no default is wrong for it


def conclusions(study: RobotStudy) -> Iterator[str]:
    """Yields what a user must know of a robot, a sentence or two for each matter."""
    for verdict in study.verdicts:
        yield judgement(study.robot, verdict)
    yield unreachable(study.collision)
    yield from alternatives(study.collision)


def judgement(robot: str, verdict: Verdict) -> str:
    """Returns whether the default of a threshold suits a robot."""
    default = f"{verdict.name}: the default {verdict.default.value:g} {verdict.unit}"
    if verdict.tuned is None:
        return f"{default} stays for {robot}, because the data support no value: {verdict.lack}."
    tuned = f"{verdict.tuned.value:g} {verdict.unit}"
    was = verdict.default.scores[TEST][verdict.measure]
    becomes = verdict.tuned.scores[TEST][verdict.measure]
    gain = verdict.gain[verdict.measure]
    note = f" ({verdict.note})" if verdict.note else ""
    scores = (
        f"{verdict.measure} {was.text()} against {becomes.text()} with {tuned}{note} on unseen seeds"
    )
    if verdict.value is None:
        return f"{default} stays for {robot}, for nothing better is proven: {scores}."
    if verdict.is_proven:
        how = "is wrong" if gain.value >= MATERIAL else "is a little worse than it could be"
        return f"{default} {how} for {robot}: {scores}; the intervals do not overlap."
    return (
        f"{default} is worse than {tuned} for {robot}: {scores}; the intervals overlap, but on the same "
        f"episodes the difference is {gain.text()}."
    )


def unreachable(study: CollisionStudy) -> str:
    """Returns the sentence on contacts that no threshold can tell."""
    blind = [spot for spot in study.unseen_contacts if spot.contacts]
    total = sum(spot.contacts for spot in blind)
    if not study.contacts:
        return "No contact took place in the episodes that check."
    if not total:
        return f"The lidar saw every one of the {study.contacts} hazards that were touched."
    reasons = ", ".join(f"{spot.contacts} {spot.sight}" for spot in blind)
    share = 100.0 * total / study.contacts
    return (
        f"No threshold can tell {total} of {study.contacts} contacts ({share:.0f} %), for the lidar did "
        f"not see the hazard: {reasons}."
    )


def alternatives(study: CollisionStudy) -> Iterator[str]:
    """Yields what the other detectors of the metrics node buy."""
    for detector in study.detectors[1:]:
        scores = detector.events.scores[TEST]
        yield (
            f"{detector.name.capitalize()} below {detector.events.value:g} m: F1 {scores['F1'].text()}, "
            f"recall {scores['recall'].text()}, "
            f"{scores['false alarms per km'].text(1)} false alarms per km."
        )
