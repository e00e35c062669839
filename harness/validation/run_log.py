"""Our side of the comparison: the log of a run as RoboTerrain's were recorded.

The terrain has posts and cubes on nearly level ground, as the inspection world of the logs; the driver
chooses its speeds as they are spread there; the noise is that of Gazebo's IMU.
"""

import math
from dataclasses import replace

import numpy as np

from harness.config import EpisodeConfig
from harness.drivers import DriverContext, Observation
from harness.drivers.wander import Wander
from harness.episode.episode import Episode
from harness.episode.metrics_feed import SampleFeed
from harness.robots import find_rover
from harness.samples import LaserScan, Tick, Twist
from harness.sensors.lidar_spec import LidarSpec
from harness.sim_time import NANOSECONDS
from harness.validation.recorded import Log, as_log
from rover_metrics.session import MetricsSession

CONFIG = EpisodeConfig(terrain="posts", difficulty=0.5, driver="cmd_vel", noise="gazebo", duration=600.0)

# Quantiles of Current Velocity in the logs of 2025-01-16 [m/s], evenly spaced from 0 to 1; the slow
# end is left to obstacles and turns.
SPEEDS = (0.15, 0.24, 0.28, 0.32, 0.36, 0.42, 0.55, 0.78, 1.0)
SPEED_HELD = (6.0, 14.0)  # [s]: recorded velocities are alike for some ten seconds
TURN_RATE = 2.0  # [rad/s]
AGENT_STREAM = 30  # keeps the agent's random numbers apart


class RecordedAgent:
    """A stand-in for the RL agents that drove when RoboTerrain's logs were recorded; seeded.

    It finds its way like the default driver, at a speed that it chooses anew every few seconds. It
    commands over cmd_vel, one control period late, as an agent behind a topic does.
    """

    def __init__(self, context: DriverContext) -> None:
        self._rng = context.rng
        unit = replace(context.rover, cruise_speed=1.0, cruise_yaw_rate=TURN_RATE)
        self._wander = Wander(replace(context, rover=unit))
        self._speed, self._until_ns = 0.0, 0

    def command(self, observation: Observation) -> Twist:
        """The default driver's command at the speed of the moment."""
        if observation.time_ns >= self._until_ns:
            held = self._rng.uniform(*SPEED_HELD)
            self._until_ns = observation.time_ns + math.floor(held * 1e9)
            place = self._rng.uniform(0, len(SPEEDS) - 1)
            self._speed = float(np.interp(place, range(len(SPEEDS)), SPEEDS))
        twist = self._wander.command(observation)
        return Twist(twist.linear * self._speed, twist.angular)


def drive(config: EpisodeConfig) -> Log:
    """Drives the run and returns its rows."""
    episode = Episode(config)
    agent = RecordedAgent(
        DriverContext(
            find_rover(config.robot),
            episode.info.map_size / 2,
            LidarSpec().bearings,
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
