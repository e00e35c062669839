"""Drivers that meet hazards on purpose."""

import math

import numpy as np
import pytest

from harness.config import EpisodeConfig
from harness.drivers import find_driver
from harness.drivers.approach import Line, line_past
from harness.drivers.base import DriverContext, Observation
from harness.episode.episode import Episode
from harness.samples import Twist
from harness.truth.traversal import Truth
from harness.world.obstacles import Obstacle, ObstacleKind, half_extent, orientation
from tests.support.rovers import LEO, ROVER_ZERO4WD

MEETING = ("ram", "reverse_into", "graze", "swing", "pass_by")


def driven(driver: str, *, robot: str = "rover_zero4wd", seed: int = 3, duration: float = 30.0) -> Truth:
    config = EpisodeConfig(
        terrain="posts", robot=robot, driver=driver, seed=seed, duration=duration, lidar_beams=2
    )
    truth = Truth()
    for batch in Episode(config).batches():
        truth = batch.truth
    return truth


@pytest.mark.parametrize("driver", ["ram", "reverse_into", "graze", "swing"])
def test_it_touches_hazards_without_tipping_over(driver: str) -> None:
    truth = driven(driver)

    assert truth.hazard_contacts >= 1
    assert truth.hazard_contact_s < 5.0
    assert not truth.tipped_over


@pytest.mark.parametrize("robot", ["leo", "rover_zero4wd"])
def test_passing_by_comes_near_and_touches_nothing(robot: str) -> None:
    truth = driven("pass_by", robot=robot)

    assert truth.hazard_contacts == 0
    assert truth.path_length > 5.0


@pytest.mark.parametrize("driver", MEETING)
def test_without_hazards_it_stands_still(driver: str) -> None:
    made = find_driver(driver)(
        DriverContext(LEO, 20.0, np.zeros(2), np.random.default_rng(0), obstacles=())
    )

    commands = [made.command(Observation(0, 0.0, 0.0, 0.0, None)) for _ in range(3)]

    assert commands == [Twist()] * 3


def test_the_speeds_of_roam_change_and_stay_below_the_top_speed() -> None:
    context = DriverContext(ROVER_ZERO4WD, 20.0, np.linspace(-3, 3, 8), np.random.default_rng(0))
    roam = find_driver("roam")(context)
    free = np.full(8, np.inf, dtype=np.float32)
    x = y = yaw = 0.0
    fastest = [0.0] * 6

    for period in range(6 * 160):  # six spells of 8 s
        twist = roam.command(Observation(period * 50_000_000, x, y, yaw, free))
        yaw += twist.angular * 0.05
        x, y = x + twist.linear * 0.05 * math.cos(yaw), y + twist.linear * 0.05 * math.sin(yaw)
        fastest[period // 160] = max(fastest[period // 160], twist.linear)

    assert max(fastest) <= ROVER_ZERO4WD.top_speed
    assert len({round(speed, 3) for speed in fastest}) == 6


def block(half_size: tuple[float, float], yaw: float) -> Obstacle:
    return Obstacle(
        kind=ObstacleKind.HAZARD,
        shape="box",
        half_size=(*half_size, 1.0),
        position=(1.0, 2.0, 0.0),
        quaternion=orientation(yaw),
    )


@pytest.mark.parametrize(
    ("yaw", "direction", "extent"),
    [(0.0, 0.0, 0.3), (0.0, math.pi / 2, 0.1), (math.pi / 2, 0.0, 0.1), (0.3, 0.3, 0.3)],
)
def test_half_extent_of_a_turned_block(yaw: float, direction: float, extent: float) -> None:
    assert half_extent(block((0.3, 0.1), yaw), direction) == pytest.approx(extent)


def test_a_line_past_an_obstacle_keeps_its_distance_on_the_left() -> None:
    line = line_past(block((0.3, 0.1), 0.0), math.pi / 2, 0.5)

    assert line.through == pytest.approx((0.5, 2.0))
    assert line.aside((1.0, 7.0)) == pytest.approx(-0.5)
    assert line.along((1.0, 7.0)) == pytest.approx(5.0)
    assert Line((0.0, 0.0), math.pi).at(2.0) == pytest.approx((-2.0, 0.0))
