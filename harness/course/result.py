"""How an episode of the course went, as it stands in a receipt: from what the referee measured.

Scores are made by + - * / only: the same bits everywhere.
"""

from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any

from harness.course.referee import REACHED, Drive
from harness.course.task import Case, Task
from harness.episode.episode import Episode
from harness.robots import RoverSpec

DECIMALS = 6
HALVING_CONTACT = 1.0  # [s] of contact with hazards that halves a score
HALVING_SCRAPE = 10.0  # [s] of scraping that does
# Work over weight and shortest way: below it energy costs nothing, so much more of it halves the score.
FREE_TRANSPORT, HALVING_TRANSPORT = 1.0, 5.0


@dataclass(frozen=True, kw_only=True)
class EpisodeResult:
    """How one episode went, as it stands in a receipt; rounded to six decimals.

    Attributes:
        track: Its name.
        seed: Of the episode.
        world: The world file's name; "" where the seed makes the world.
        world_hash: SHA-256 of all that a rover can feel or meet there.
        model_hash: SHA-256 of the rover's model.
        ending: "reached", "contact", "tipped", "time", or why it ended by itself.
        goals: How many were reached; `of_goals` is how many there are.
        time: From the clock's start [s].
        optimal: Time that the shortest way takes at best [s].
        path: Length of the way that was driven [m].
        shortest: Length of the shortest way [m].
        hazard_s: Contact with hazards [s].
        scrape_s: The body on the ground [s].
        energy: Work of the wheels' motors, braking counted as driving [J].
        risk_s: Time with a hazard or a person within 0.5 m [s].
        tilt_p95: 95th percentile of the tilt over time [rad].
        penalty: What is left of the score by contact, scraping and energy, 0 to 1.
        spl: Success weighted by path length.
        score: Of the episode, 0 to 1.
    """

    track: str
    seed: int
    world: str
    world_hash: str
    model_hash: str
    ending: str
    goals: int
    of_goals: int
    time: float
    optimal: float
    path: float
    shortest: float
    hazard_s: float
    scrape_s: float
    energy: float
    risk_s: float
    tilt_p95: float
    penalty: float
    spl: float
    score: float

    @property
    def is_success(self) -> bool:
        """Whether all goals were reached by the rules."""
        return self.ending == REACHED


FIELDS = tuple(item.name for item in fields(EpisodeResult))


def result_of(case: Case, task: Task, driven: Drive, episode: Episode) -> EpisodeResult:
    """Returns the result of a drive, scored.

    Args:
        case: Track, seed and world of the episode.
        task: What was to be driven, and how it is judged.
        driven: What the referee has measured.
        episode: Has come to its end.
    """
    truth, info = driven.truth, episode.info
    reduced = penalty(task, driven, weight_of(episode.simulation.scene.rover))
    values: dict[str, Any] = {
        **{item.name: getattr(driven, item.name) for item in fields(driven) if item.name != "truth"},
        "track": case.track,
        "seed": case.seed,
        "world": "" if case.world is None else case.world.name,
        "world_hash": info.terrain_hash,
        "model_hash": info.model_hash,
        "of_goals": 0 if task.run.plan.route is None else len(task.run.plan.route.points),
        "optimal": task.optimal,
        "path": truth.path_length,
        "shortest": task.shortest,
        "hazard_s": truth.hazard_contact_s,
        "scrape_s": truth.scrape_s,
        "penalty": reduced,
        "spl": spl(task, driven),
        "score": score(task, driven, reduced),
    }
    for name, value in values.items():
        values[name] = round(value, DECIMALS) if isinstance(value, float) else value
    return EpisodeResult(**values)


@lru_cache(maxsize=4)
def weight_of(rover: RoverSpec) -> float:
    """Returns the weight of a rover [N]."""
    from harness.robots.model import compiled_alone  # noqa: PLC0415 - MuJoCo

    model, _ = compiled_alone(rover)
    return float(sum(model.body_mass.tolist())) * rover.gravity


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
