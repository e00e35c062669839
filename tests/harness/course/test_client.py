"""What a client knows of where it is."""

import numpy as np

from harness.course.client import Client
from harness.drivers.base import Observation
from harness.episode.assembly import injector
from harness.episode.episode import Episode
from harness.episode.loop import Route, drive
from harness.episode.together import together
from harness.samples import Sample, Twist
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
