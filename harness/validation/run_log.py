"""Our side of the comparison: the log of a run as RoboTerrain's were recorded.

The terrain has posts and cubes on nearly level ground, as the inspection world of the logs; the driver
chooses its speeds as they are spread there; the noise is that of Gazebo's IMU.
"""

import numpy as np

from harness.config import EpisodeConfig
from harness.drivers import DriverContext, Observation
from harness.episode.episode import Episode
from harness.episode.metrics_feed import SampleFeed
from harness.robots import find_rover
from harness.samples import LaserScan, Tick
from harness.sensors.lidar import beam_bearings
from harness.sensors.lidar_spec import LidarSpec
from harness.sim_time import NANOSECONDS
from harness.validation.agent import RecordedAgent
from harness.validation.recorded import Log, as_log
from rover_metrics.session import MetricsSession

CONFIG = EpisodeConfig(terrain="posts", difficulty=0.5, driver="cmd_vel", noise="gazebo", duration=600.0)
AGENT_STREAM = 30  # keeps the agent's random numbers apart


def drive(config: EpisodeConfig) -> Log:
    """Drives the run and returns its rows."""
    episode = Episode(config)
    agent = RecordedAgent(
        DriverContext(
            find_rover(config.robot),
            episode.info.map_size / 2,
            beam_bearings(LidarSpec()),
            np.random.default_rng([config.seed, AGENT_STREAM]),
        )
    )
    logger = _Logger()
    for batch in episode.batches():
        for tick in batch.ticks:
            logger.take(tick)
        episode.command(agent.command(logger.observe(episode)))
    return as_log(np.array(logger.rows), "the run")


class _Logger:
    """Feeds a session of metrics, and keeps one row a second and the latest scan."""

    def __init__(self) -> None:
        self._session, self._scan = MetricsSession(), LaserScan(0, np.empty(0, dtype=np.float32))
        self._feed = SampleFeed(self._session, LidarSpec())
        self.rows: list[tuple[float, ...]] = []

    def take(self, tick: Tick) -> None:
        """Takes the samples of a tick, then the row if a second is full."""
        for sample in tick.samples:
            self._feed.take(sample)
            if isinstance(sample, LaserScan):
                self._scan = sample
        if tick.stamp_ns % NANOSECONDS == 0:
            row = self._session.metrics.row(tick.stamp_ns // NANOSECONDS)
            self.rows.append(
                (
                    row.imu_acceleration_magnitude,
                    row.vertical_roughness,
                    row.current_velocity,
                    row.obstacle_clearance,
                )
            )

    def observe(self, episode: Episode) -> Observation:
        """What the agent may know."""
        simulation = episode.simulation
        x, y, _ = simulation.position
        ranges = self._scan.ranges if self._scan.ranges.size else None
        return Observation(simulation.time_ns, x, y, simulation.yaw, ranges)
