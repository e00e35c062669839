"""The social log of a run, against where rover and people were by the episode's own truth."""

import math
import os
from dataclasses import replace
from pathlib import Path

import pytest

from harness.base.errors import RunFailed, UsageError
from harness.episode.batch import Batch
from harness.episode.social_recorder import SocialRecorder
from harness.samples import ActorPoses, Place, Pose, Quaternion, Tick, Truth
from rover_metrics.analysis.social.log import read_social_log

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def batch(
    second: int, x: float, *goals: Place, y: float = 0.0, orientation: Quaternion = UPRIGHT
) -> Batch:
    stamp = second * 10**9
    people = ActorPoses(stamp, ((x, 3.0, 1.0), (x + 1.0, 0.0, 1.0)), (UPRIGHT, UPRIGHT))
    ticks = (Tick(stamp, (Pose(stamp, (x, y, 0.2), orientation), people)),)
    return Batch(ticks, Truth(time_ns=stamp, position=(x, y, 0.2)), goals=goals)


@pytest.mark.parametrize("began", [0, 3600])
def test_each_second_has_a_row_and_goals_count_from_when_they_are_given(
    began: int, tmp_path: Path
) -> None:
    log = SocialRecorder(("b_actor", "a_actor"), None, tmp_path)
    assert log.path is None
    goals = [(), (Place(2.1, 0.0, 0.0),), (), (Place(4.2, 0.0, 0.0), Place(9.0, 0.0, 0.0)), ()]
    for second, given in enumerate(goals, 1):
        log.take(batch(began + second, float(second), *given))
    sixth = batch(began + 6, 6.0)
    for sample in sixth.ticks[0].samples:  # either place alone
        log.take(replace(sixth, ticks=(Tick((began + 6) * 10**9, (sample,)),)))
    log.close()
    assert log.path is not None
    assert (log.path.parent, log.path.name[:11]) == (tmp_path / "social", "social_log_")
    told = read_social_log(log.path)  # so none of the sixth
    assert told.actors == ("a", "b")
    assert told.distance.tolist() == [[1.0, 3.0]] * 5
    assert told.position.tolist() == [[float(x), 0.0] for x in range(1, 6)]
    assert told.goals.tolist() == [0, 0, 1, 1, 1]  # of the second in which it was reached: from the next
    assert (log.goals.reached, log.goals.goal) == (1, (9.0, 0.0))


def test_a_goal_is_reached_at_its_place_and_failed_by_a_rover_on_its_side(tmp_path: Path) -> None:
    log, half = SocialRecorder(("a_actor", "b_actor"), None, tmp_path), math.sqrt(0.5)
    log.take(replace(batch(0, 2.0, Place(9.0, 9.0, 0.0)), ticks=()))  # nothing has been read yet
    assert (log.goals.reached, log.goals.failed) == (0, 0)
    log.take(batch(1, 2.0, Place(2.0, 5.0, 0.0), y=5.1))
    assert (log.goals.reached, log.goals.failed) == (1, 0)
    log.take(batch(2, 2.0, Place(9.0, 5.0, 0.0), orientation=(half, 0.0, 0.0, half)))
    third = batch(3, 2.0)
    log.take(replace(third, truth=replace(third.truth, time_ns=3_050_000_000)))  # a tick within it
    log.close()
    assert (log.goals.reached, log.goals.failed) == (1, 1)
    assert log.path is not None
    assert read_social_log(log.path).goals.tolist() == [0, 1, 1]
    assert log.path.read_text().splitlines()[-1].startswith("3,3.00,2.00,0.00,")


def test_a_log_of_that_name_is_replaced_on_request_with_the_first_row(tmp_path: Path) -> None:
    there = tmp_path / "there.csv"
    there.write_text("precious")
    log = SocialRecorder(("a_actor", "b_actor"), there, tmp_path, overwrite=True)
    assert there.read_text() == "precious"
    log.take(batch(1, 0.0))
    log.close()
    assert len(there.read_text().splitlines()) == 2


def test_what_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "there.csv").touch()
    os.mkfifo(tmp_path / "pipe.csv")
    wrong = {"log.txt": "does not end in .csv", "there.csv": "exists already", "pipe.csv": "is no file"}
    for name, told in wrong.items():
        overwrite = name == "pipe.csv"
        with pytest.raises(UsageError, match=told):
            SocialRecorder(("a_actor", "b_actor"), tmp_path / name, tmp_path, overwrite=overwrite)
    log = SocialRecorder(("a_actor", "b_actor"), None, tmp_path / "there.csv")
    with pytest.raises(RunFailed, match="the social log: cannot create a log"):
        log.take(batch(1, 0.0))
