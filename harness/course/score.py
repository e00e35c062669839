"""The score of an episode, 0 to 1, and what stands beside it; only + - * /, the same bits everywhere."""

from harness.course.referee import REACHED, Drive
from harness.course.task import Task

HALVING_CONTACT = 1.0  # [s] of contact with hazards that halves a score
HALVING_SCRAPE = 10.0  # [s] of scraping that does
# Work over weight and shortest way: below it energy costs nothing, so much more of it halves the score.
FREE_TRANSPORT, HALVING_TRANSPORT = 1.0, 5.0


def score(task: Task, drive: Drive, reduced: float) -> float:
    """Returns success x optimal / clip(time, fastest x optimal, slowest x optimal) x penalty, 0 to 1.

    Args:
        task: Has the optimal time and the rule with fastest and slowest.
        drive: What the referee has measured.
        reduced: The penalty: what is left of the score, 0 to 1.
    """
    if drive.ending != REACHED:
        return 0.0
    rule, best = task.rule, task.optimal
    clipped = min(max(drive.time, rule.fastest * best), rule.slowest * best)
    return best / clipped * reduced


def penalty(task: Task, drive: Drive, weight: float) -> float:
    """Returns what contact, scraping and energy leave of the score, 0 to 1.

    Args:
        task: What was asked.
        drive: What the referee has measured.
        weight: Of the rover [N].
    """
    if not task.rule.penalties:
        return 1.0
    transport = drive.energy / (weight * task.shortest) - FREE_TRANSPORT
    of_energy = 1.0 + max(0.0, transport) / HALVING_TRANSPORT
    of_contact = 1.0 + drive.truth.hazard_contact_s / HALVING_CONTACT
    of_scraping = 1.0 + drive.truth.scrape_s / HALVING_SCRAPE
    return 1.0 / (of_contact * of_scraping * of_energy)


def spl(task: Task, drive: Drive) -> float:
    """Returns success weighted by path length: shortest / max(path, shortest), 0 without success."""
    if drive.ending != REACHED:
        return 0.0
    return task.shortest / max(drive.truth.path_length, task.shortest)
