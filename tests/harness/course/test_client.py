"""What a client knows of where it is."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.course.attempt import Client
from harness.drivers.base import Observation
from harness.episode.assembly import injector
from harness.episode.episode import Episode
from harness.episode.loop import Route, drive
from harness.episode.together import Together
from harness.samples import GoalPose, Sample, Tick, Twist
from harness.spec.run import Run


class Places:
    """A driver that keeps when and where it was."""

    summary, senses = "", frozenset[type[Sample]]()

    def __init__(self) -> None:
        self.seen = list[tuple[int, float, float]]()
        self.goals = list[tuple[float, float, float]]()

    def head_for(self, x: float, y: float, yaw: float) -> None:
        self.goals.append((x, y, yaw))

    def command(self, observation: Observation) -> Twist:
        self.seen.append((observation.time_ns, observation.x, observation.y))
        return Twist(0.3, 0.0)


def test_a_client_is_where_it_was_last_told_to_be_while_its_poses_are_no_numbers() -> None:
    run = Run.of(terrain="flat", driver="cmd_vel", duration=2.0, faults=("pose:nan=0.5@0.1",))
    episode, driver = Episode(run), Places()
    client = Client(driver, episode)  # type: ignore[arg-type]  # made without a context
    for _ in drive(Together((episode,)).batches(), (Route(injector(run), client.hear, (client,)),)):
        pass
    times, x, y = np.array(driver.seen).T
    assert times.tolist() == [50_000_000 * number for number in range(1, 41)]
    assert np.isfinite([x, y]).all()
    assert x[-1] > 0.2
    assert 0.2 < np.mean(np.diff(x[10:]) == 0.0) < 0.8  # half of them tell it nothing


def test_a_client_is_given_the_goals_that_are_published_with_their_headings() -> None:
    run = Run.of(terrain="flat", driver="cmd_vel", duration=3.0, route="0.5,0/-1,2:radius=0.4")
    episode, driver = Episode(run), Places()
    client, told = Client(driver, episode), list[tuple[float, float, float]]()  # type: ignore[arg-type] # as above

    def hear(tick: Tick, sent: Tick) -> None:
        for goal in (one for one in sent.samples if isinstance(one, GoalPose)):
            told.append((*goal.position[:2], Rotation.from_quat(goal.orientation).as_euler("zyx")[0]))
        client.hear(tick, sent)

    for _ in drive(Together((episode,)).batches(), (Route(injector(run), hear, (client,)),)):
        pass
    assert np.array(driver.goals) == pytest.approx(np.array(told))
    assert len({yaw for *_, yaw in told}) == len(told) == 2
