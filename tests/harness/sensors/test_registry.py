"""Every sensor of the table by the same rules: rate, frame, finite values, noise, seed and topics."""

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from pkgutil import resolve_name

import numpy as np
import pytest

from harness.base.message_types import typestore
from harness.base.sim_time import period_ticks
from harness.episode.assembly import sensor_rows
from harness.episode.episode import Episode
from harness.robots import ROVERS
from harness.robots.frames.rover_frames import rover_frames
from harness.samples import Imu, LaserScan, Odometry, Sample, Source, Transforms, TruthState, source
from harness.sensors.base import EpisodeParts, Sensor
from harness.sensors.choice import by_default
from harness.sensors.suite import SensorSuite
from harness.sensors.table import SENSORS, SensorRow, by_fault_name
from harness.spec.ros import FrameOptions
from harness.spec.run import Run
from tests.harness.conftest import MakeSimulation
from tests.support.rovers import LEO

ALL = ("lidar2d", "lidar3d", "depth", "camera=small", "gnss", "magnetometer", "barometer", "height_scan")
RUN = Run.of(terrain="posts", driver="figure8", lidar_beams=8, duration=0.5, sensors=list(ALL))
ROWS = sensor_rows(RUN.rover)
RANGING, CHIPS = {LaserScan, Imu, "lidar2d", "lidar3d", "depth"}, {"gnss", "magnetometer", "barometer"}

each = pytest.mark.parametrize("row", ROWS, ids=lambda row: row.fault or row.sample.__name__)


@cache
def readings(noise: str | None = None, sensors: Sequence[str] = ALL) -> dict[Source, list[Sample]]:
    """What the sensors of a short run read."""
    run = RUN.alone(noise=noise, sensors=list(sensors) or ["none"])
    read: dict[Source, list[Sample]] = {}
    for batch in Episode(run, frame_options=FrameOptions()).batches():
        for sample in (sample for tick in batch.ticks for sample in tick.samples):
            read.setdefault(source(sample), []).append(sample)
    return read


def values(samples: Sequence[Sample]) -> bytes:
    """Every value of samples."""
    each = [getattr(sample, name) for sample in samples for name in sample.__dataclass_fields__]
    return repr([value.tobytes() if isinstance(value, np.ndarray) else value for value in each]).encode()


@each
def test_its_frame_is_one_of_the_rovers_and_its_rate_divides_the_clock(row: SensorRow) -> None:
    for rover in ROVERS.values():
        mounts = [row.given.frames(rover) for row in ROWS if row.given is not None]
        links = {link.name for link in rover_frames(rover, sum(mounts, ())).links}
        assert row.frame_on(rover) in links | {"", "odom", "world"}
        assert period_ticks(row.rate_on(rover)) >= 1


@pytest.mark.parametrize(
    ("noise", "corrupted"),
    [("white", RANGING), ("hardware", RANGING | CHIPS | {Odometry}), ("gazebo", {Imu})],
)
def test_noise_corrupts_these_sensors_and_no_others(noise: str, corrupted: set[Source]) -> None:
    exact, noisy = readings(), readings(noise)
    assert {kind for kind in exact if values(exact[kind]) != values(noisy[kind])} == corrupted


@each
def test_faults_of_values_and_of_attitudes_change_fields_apart_in_the_samples_order(
    row: SensorRow,
) -> None:
    """Attitudes are changed only where a user says so; images are drawn from what no fault may touch."""
    names = [*row.sample.__dataclass_fields__]
    places = [names.index(name) for name in row.measured]
    assert all(one < other for one, other in pairwise(places)), "the order of the random draws"
    attitudes = {name for name in names if name in ("orientation", "yaw")} if not row.options else set()
    assert set(row.attitude) == attitudes
    assert not {*row.measured} & {*row.attitude, "stamp_ns", "sensor", "x" if row.options else ""}
    assert bool(row.measured) == (row.fault not in (None, "camera"))


def test_all_but_the_truth_can_have_faults_and_every_factory_is_where_the_table_says() -> None:
    assert [row.sample for row in by_default() if row.fault is None] == [TruthState]
    assert by_fault_name(()) == {}
    topics = [topic for row in SENSORS for topic in row.topics]
    assert {topic.message_type for topic in topics} <= set(typestore().fielddefs)
    assert [topic.name for topic in topics if topic.best_effort] == ["rover/pose_array"]
    assert {topic.name: topic.depth for topic in topics if topic.depth != 10} == {"tf": 100}
    for factory in (row.factory for row in SENSORS):
        kind = resolve_name(factory) if isinstance(factory, str) else factory
        assert issubclass(kind, Sensor)


def test_an_episode_without_a_part_does_without_the_sensors_that_need_it(
    make_simulation: MakeSimulation,
) -> None:
    simulation = make_simulation("leo")
    suite = SensorSuite(EpisodeParts(simulation=simulation), LEO, {Imu: 50}, rows=ROWS)
    simulation.tick()
    made = {source(sample) for sample in suite.tick(100)}
    lacking = {Transforms, LaserScan, TruthState, *(row.given.name for row in ROWS if row.given)}
    assert made == {row.source for row in ROWS} - lacking
    suite.tick(101)
    assert [type(sample) for sample in suite.tick(102)][:1] == [Imu]  # at the rate that is asked for
