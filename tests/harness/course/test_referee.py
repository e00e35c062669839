"""What a referee counts of a drive, against what its samples say."""

import math

import numpy as np
import pytest

from harness.course.attempt import MEASURED
from harness.course.client import Client
from harness.course.referee import RISK_DISTANCE, Referee
from harness.course.task import Rule, Task
from harness.drivers.base import Observation
from harness.episode.assembly import injector
from harness.episode.episode import Episode
from harness.episode.loop import Route, drive
from harness.episode.together import together
from harness.samples import ActorPoses, JointStates, Sample, Twist
from harness.spec.run import Run


class Places:
    """A driver that keeps where it was."""

    summary, senses = "", frozenset[type[Sample]]()

    def __init__(self) -> None:
        self.seen = list[tuple[float, float]]()

    def command(self, observation: Observation) -> Twist:
        self.seen.append((observation.x, observation.y))
        return Twist(0.3, 0.0)


def test_a_client_is_where_it_was_last_told_to_be_while_its_poses_are_no_numbers() -> None:
    run = Run.of(terrain="flat", driver="cmd_vel", duration=2.0, faults=("pose:nan=0.5@0.1",))
    episode, driver = Episode(run), Places()
    client = Client(driver, episode)  # type: ignore[arg-type]  # made without a context
    for _ in drive(together((episode,)), (Route(injector(run), client.hear, (client,)),)):
        pass
    assert len(driver.seen) == 40
    assert np.isfinite(driver.seen).all()
    assert driver.seen[-1][0] > 0.2


DRIVE = ((0.1, 0.8, 0.0), (3.5, -0.8, 0.6), (5.0, 0.0, 0.0))


def test_energy_is_all_work_of_the_motors_and_risk_and_time_are_counted_by_the_rules() -> None:
    near, far = "walker=2,-2/2,6:radius=0.4", "other=-9,9/9,9"
    run = Run.of(
        terrain="slope", driver="cmd_vel", route="9,0", actors=(near, far), duration=6.0, commands=DRIVE
    )
    episode = Episode(run, samples=MEASURED)
    referee = Referee(
        Task(run=run, shortest=9.0, optimal=9.0, rule=Rule(begins_at=0.3)),
        episode.simulation.scene.world,
    )
    powers, away, risk_s = list[float](), list[float](), 0.0
    start = episode.simulation.scene.world.start[:2]
    for batch in episode.batches():
        referee.take(batch)
        samples = [sample for tick in batch.ticks for sample in tick.samples]
        joints = [each for each in samples if isinstance(each, JointStates)]
        powers += [e * v for each in joints for e, v in zip(each.effort, each.velocity, strict=True)]
        people = [each for each in samples if isinstance(each, ActorPoses)]
        gap = math.dist(people[-1].position[0][:2], batch.truth.position[:2]) - 0.4
        risk_s += 0.05 * (gap < RISK_DISTANCE)
        away.append(math.dist(batch.truth.position[:2], start))
    came = referee.drive()
    assert min(powers) < -1.0  # motors also brake
    assert came.energy == pytest.approx(np.abs(powers).sum() / 50.0)
    assert 0.0 < risk_s < 6.0
    assert came.risk_s == pytest.approx(risk_s)
    assert came.time == pytest.approx(6.0 - 0.05 * (1 + np.argmax(np.array(away) >= 0.3)))
