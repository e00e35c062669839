"""One episode of an entry: the project's own loop, a client that commands, a referee that watches."""

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

import numpy as np

from harness.base.errors import RunFailed
from harness.base.streams import EPISODE, seeded
from harness.course.client import Client
from harness.course.entry import Entry, unpack
from harness.course.referee import Drive, Referee
from harness.course.score import penalty, score, spl
from harness.course.task import Case, Task
from harness.course.tracks import find_track
from harness.drivers import find_driver
from harness.drivers.base import Driver, DriverContext
from harness.drivers.policy import PolicyDriver, read_policy
from harness.episode.assembly import injector
from harness.episode.episode import Episode
from harness.episode.loop import Route, drive
from harness.episode.together import together
from harness.robots import RoverSpec
from harness.samples import ActorPoses, JointStates, Pose, Sample
from harness.sensors.lidar_spec import LidarSpec

DECIMALS = 6
D = TypeVar("D", bound=Driver)
MEASURED: frozenset[type[Sample]] = frozenset((Pose, JointStates, ActorPoses))


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
        return self.ending == "reached"


def attempt(case: Case, *, entry: Entry) -> EpisodeResult:
    """Drives an episode and returns how it went; UsageError if entry or world are not valid."""
    with TemporaryDirectory(prefix="rover-course-") as scratch:
        folder = Path(scratch)
        unpack(entry, folder)
        task = find_track(case.track).task(case, folder)
        if entry.about is not None and entry.about.launch:
            from harness.course.node_entry import drive_node  # noqa: PLC0415 - only this needs ROS 2

            return drive_node(case, task, entry.about, folder)
        kind = find_driver(entry.driver(case.track, folder))
        return _driven(case, _seen_by(kind, task), kind)[0]


def drive_with(case: Case, kind: type[D]) -> tuple[EpisodeResult, D]:
    """Returns how an episode goes with a driver of Python, and that driver: to look at, and to learn."""
    with TemporaryDirectory(prefix="rover-course-") as scratch:
        return _driven(case, find_track(case.track).task(case, Path(scratch)), kind)


def _seen_by(kind: type[Driver], task: Task) -> Task:
    """The task with the lidar that a policy was made for; any other driver takes the track's."""
    if not issubclass(kind, PolicyDriver):
        return task
    return replace(task, run=task.run.alone(lidar_beams=read_policy(kind.file).beams))


def _driven(case: Case, task: Task, kind: type[D]) -> tuple[EpisodeResult, D]:
    episode = Episode(task.run, samples=MEASURED | kind.senses)
    scene = episode.simulation.scene
    referee = Referee(task, scene.world)
    driver = kind(_context(episode))
    client = Client(driver, episode)
    route = Route(injector(task.run), client.hear, (referee, client))
    failure = ""
    try:
        for _ in drive(together((episode,)), (route,)):
            if referee.ending:
                break
    except RunFailed as error:
        failure = str(error)
    return result_of(case, task, referee.drive(failure), episode), driver


def _context(episode: Episode) -> DriverContext:
    """What a driver is made for: the rover and its lidar, without the world's obstacles."""
    scene, run = episode.simulation.scene, episode.run
    middle, half_size = scene.world.roaming
    bearings = LidarSpec(beams=run.rover.lidar_beams).bearings(scene.rover.lidar_yaw)
    rng = np.random.default_rng(seeded(run.seed, EPISODE).spawn(1)[0])
    return DriverContext(scene.rover, half_size, bearings, rng, middle=middle)


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
    from harness.robots.model import compiled, read_model  # noqa: PLC0415 - MuJoCo

    masses = compiled(read_model(rover), rover.model_path).body_mass.tolist()
    return float(sum(masses)) * rover.gravity


FIELDS = tuple(item.name for item in fields(EpisodeResult))
