"""A rover of six wheels drives an episode and logs a slip for each of them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from harness.episode.episode import Episode
from harness.episode.metrics_feed import (
    SampleFeed,
    extended_parameters,
    extended_settings,
)
from harness.robots import RoverSpec
from harness.samples import TruthState
from harness.sensors.lidar_spec import LidarSpec
from harness.spec.run import Run
from rover_metrics.session import MetricsSession
from tests.support.rovers import LEO

WHEELS = [f"{end} {side}" for side in ("Left", "Right") for end in ("Front", "Middle", "Rear")]


def test_each_of_six_wheels_has_its_column(foreign: Callable[[str], RoverSpec]) -> None:
    rover = foreign("sojourner")
    config = Run.of(robot=str(rover.folder), terrain="flat", driver="spin", duration=0.5)
    session = MetricsSession(settings=extended_settings(rover))
    feed = SampleFeed(session, LidarSpec(beams=config.lidar_beams))
    batches = list(Episode(config, samples={TruthState}).batches())
    samples = [sample for batch in batches for tick in batch.ticks for sample in tick.samples]
    for sample in samples:
        feed.take(sample)
    states = [sample for sample in samples if isinstance(sample, TruthState)]
    row = session.row(1_000_000_000)
    told = dict(zip(row.columns, row.as_fields(), strict=True))
    assert [name for name in told if name.startswith("True Slip")] == [f"True Slip {w}" for w in WHEELS]
    for place, wheel in enumerate(WHEELS):
        mean = sum(state.slip[place] for state in states) / len(states)
        assert abs(float(told[f"True Slip {wheel}"]) - mean) < 1e-4
    assert len(batches[-1].truth.wheel_slip) == 6
    assert abs(states[-1].slip[0]) > 0.05  # it turns in place: wheels slip


def test_people_touch_a_rover_whatever_its_bodies_are_called(
    foreign: Callable[[str], RoverSpec],
) -> None:
    robot = str(foreign("husky").folder)
    config = Run.of(robot=robot, terrain="flat", driver="spin", duration=0.1, actors=("a=0.3,0",))
    (*_, last) = Episode(config, samples=set()).batches()
    assert [(event.kind, event.other) for event in last.events] == [("hazard", "a_actor")]


def test_a_node_is_told_of_other_wheels_than_the_usual_four(foreign: Callable[[str], RoverSpec]) -> None:
    told = "front_left,middle_left,rear_left,front_right,middle_right,rear_right"
    assert extended_parameters(extended_settings(foreign("sojourner")))["wheels"] == told
    assert "wheels" not in extended_parameters(extended_settings(LEO))


def test_the_lidar_of_a_rover_tells_where_it_looks(foreign: Callable[[str], RoverSpec]) -> None:
    rover = replace(foreign("buggy"), lidar_x=0.1, lidar_y=-0.2, lidar_yaw=0.5, folder=Path())
    pose = extended_settings(rover).lidar_pose
    assert (pose.x, pose.y, pose.yaw) == (0.1, -0.2, 0.5)
    beams = LidarSpec(beams=9, angle_max=1.0)
    assert abs(beams.bearings_at(0.5) - (beams.angles + 0.5)).max() < 1e-12
