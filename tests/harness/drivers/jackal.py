"""A Jackal that drives as it is told, among what a test's lidar sees."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.drivers.base import DriverContext, Observation
from harness.robots import find_rover
from harness.robots.lidar import LidarSpec
from harness.samples import Twist

ROVER = find_rover("jackal")
BEARINGS = LidarSpec(beams=720).bearings(ROVER.lidar_yaw)

Pose = tuple[float, float, float]  # x, y [m], yaw [rad]
Look = Callable[[Pose], NDArray[np.float32]]


def context() -> DriverContext:
    return DriverContext(ROVER, (50.0, 50.0), BEARINGS, np.random.default_rng(0))


class Turned:
    """A driver to whom the world is turned by half a turn."""

    def __init__(self, driver: Any) -> None:  # noqa: ANN401 - takes goals
        self._driver = driver

    def head_for(self, x: float, y: float, yaw: float) -> None:
        self._driver.head_for(-x, -y, math.remainder(yaw + math.pi, math.tau))

    def command(self, seen: Observation) -> Twist:
        yaw = math.remainder(seen.yaw + math.pi, math.tau)
        twist: Twist = self._driver.command(replace(seen, x=-seen.x, y=-seen.y, yaw=yaw))
        return twist


def lidar(pose: Pose) -> tuple[float, float, NDArray[np.float64]]:
    """Where the lidar is in the world [m], and the direction of each beam [rad]."""
    x, y, yaw = pose
    return x + ROVER.lidar_x * math.cos(yaw), y + ROVER.lidar_x * math.sin(yaw), BEARINGS + yaw


def drives(driver: Any, look: Look, periods: int) -> Iterator[tuple[Pose, Twist]]:  # noqa: ANN401 - takes goals
    """Yields each pose that is driven to from the origin without slip, and the command there."""
    x = y = yaw = 0.0
    for period in range(periods):
        seen = Observation(period, x, y, yaw, ranges=look((x, y, yaw)), readings={})
        twist = driver.command(seen)
        yaw += 0.05 * twist.angular
        x, y = x + 0.05 * twist.linear * math.cos(yaw), y + 0.05 * twist.linear * math.sin(yaw)
        yield (x, y, yaw), twist
