"""Both sides of the comparison: logs that were recorded, and a run of ours as RoboTerrain's were.

The terrain has posts and cubes on nearly level ground, as the inspection world of the logs; the driver
chooses its speeds as they are spread there; the noise is that of Gazebo's IMU.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS
from harness.base.streams import VALIDATION_AGENT
from harness.drivers.base import DriverContext, Observation
from harness.drivers.wander import Roam
from harness.episode import loop
from harness.episode.assembly import injector
from harness.episode.batch import Batch
from harness.episode.episode import Episode
from harness.episode.loop import Route
from harness.episode.metrics_feed import SampleFeed
from harness.episode.together import Together
from harness.robots.lidar import LidarSpec
from harness.samples import LaserScan, Tick
from harness.spec.run import Run
from rover_metrics.analysis.logs.header import UnreadableLog
from rover_metrics.analysis.logs.reading import read_log as read_metrics_log
from rover_metrics.analysis.metric import METRICS
from rover_metrics.session import MetricsSession

COLUMNS = {  # that show how a run went, with their units
    "IMU Acceleration Magnitude": "m/s2",
    "Vertical Roughness": "m/s2",
    "Current Velocity": "m/s",
    "Obstacle Clearance": "m",
}
_METRICS = [metric for metric in METRICS.values() if metric.column in COLUMNS and not metric.rough_only]
RUN = Run.of(terrain="posts", difficulty=0.5, driver="cmd_vel", noise="gazebo", duration=600.0)

# Quantiles of Current Velocity in the logs of 2025-01-16 [m/s], evenly spaced from 0 to 1; the slow
# end is left to obstacles and turns.
SPEEDS = (0.15, 0.24, 0.28, 0.32, 0.36, 0.42, 0.55, 0.78, 1.0)
SPEED_HELD = (6.0, 14.0)  # [s]: recorded velocities are alike for some ten seconds
TURN_RATE = 2.0  # [rad/s]

Values = NDArray[np.float64]
Log = Mapping[str, Values]  # by column


def read_log(path: Path) -> Log:
    """Returns those columns of a log; rows whose clearance is still infinite are left out.

    Raises:
        UsageError: It cannot be read, or lacks a column or a row.
    """
    try:
        log = read_metrics_log(path, _METRICS)
    except UnreadableLog as error:
        raise UsageError(f"{path}: {error}; --realism takes two logs") from error
    if lacking := [column for column in COLUMNS if column not in log.columns]:
        raise UsageError(f"{path} has no column {', '.join(lacking)}")
    values: Values = np.array([log.columns[column] for column in COLUMNS], np.float64)
    return _complete(values.T, str(path))


def _complete(values: Values, name: str) -> Log:
    """Returns rows in the order of COLUMNS as a log, those that are not finite left out."""
    finite = values[np.isfinite(values).all(axis=1)]
    if not len(finite):
        raise UsageError(f"{name} holds no complete row")
    return dict(zip(COLUMNS, finite.T, strict=True))


class RecordedAgent(Roam):
    """A stand-in for the RL agents that drove when RoboTerrain's logs were recorded; seeded.

    It finds its way like the default driver, at a speed that it chooses anew every few seconds. It
    commands over cmd_vel, one control period late, as an agent behind a topic does.
    """

    def __init__(self, context: DriverContext) -> None:
        unit = context.rover.but(cruise_speed=1.0, cruise_yaw_rate=TURN_RATE)
        super().__init__(replace(context, rover=unit))

    def spell(self) -> tuple[float, float]:
        """Returns how long the next speed holds [s], and the speed [m/s]."""
        held = self.rng.uniform(*SPEED_HELD)
        place = self.rng.uniform(0, len(SPEEDS) - 1)
        return held, float(np.interp(place, range(len(SPEEDS)), SPEEDS))


class Agent:
    """Lets an agent command an episode over cmd_vel after every batch; an Observer."""

    def __init__(self, episode: Episode, agent: RecordedAgent) -> None:
        self._episode, self._agent = episode, agent
        self._ranges: NDArray[np.float32] | None = None

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        for tick in batch.ticks:
            if (scan := tick.of(LaserScan)) is not None:
                self._ranges = scan.ranges
        simulation, (x, y, _) = self._episode.simulation, self._episode.simulation.position
        seen = Observation(simulation.time_ns, x, y, simulation.yaw, self._ranges)
        self._episode.command(self._agent.command(seen))


def drive(run: Run) -> Log:
    """Drives a run by a RecordedAgent and returns its rows, one per second."""
    episode, session, lidar = Episode(run), MetricsSession(), LidarSpec()
    feed, rng = SampleFeed(session, lidar), np.random.default_rng([run.seed, VALIDATION_AGENT])
    width, depth = episode.info.map_size
    half_size = width / 2, depth / 2
    rover = episode.simulation.scene.rover
    bearings = lidar.bearings(rover.lidar_yaw)
    agent = RecordedAgent(DriverContext(rover, half_size, bearings, rng))

    def sink(_: Tick, sent: Tick) -> None:
        for sample in sent.samples:
            feed.take(sample)

    rows = []
    route = Route(injector(run), sink, (Agent(episode, agent),))
    for tick in loop.drive(Together((episode,)).batches(), (route,)):
        if tick.stamp_ns % NANOSECONDS == 0:
            row = session.metrics.row(tick.stamp_ns // NANOSECONDS)
            imu = (row.imu_acceleration_magnitude, row.vertical_roughness)
            rows.append((*imu, row.current_velocity, row.obstacle_clearance))
    return _complete(np.array(rows).reshape(-1, len(COLUMNS)), "the run")
