import math

import numpy as np
import pytest

from harness.drivers.base import DriverContext, Observation
from harness.drivers.wander import BACK_OUT_NS, STUCK_AFTER_NS, Wander
from tests.support.rovers import LEO

BEARINGS = np.linspace(-math.pi, math.pi, 360, endpoint=False)
PERIOD_NS = 50_000_000


def wander(seed: int = 0) -> Wander:
    return Wander(DriverContext(LEO, 20.0, BEARINGS, np.random.default_rng(seed)))


def seen(
    time_ns: int = 0, x: float = 0.0, y: float = 0.0, ranges: np.ndarray | None = None
) -> Observation:
    return Observation(time_ns, x, y, 0.0, None if ranges is None else ranges.astype(np.float32))


def open_space() -> np.ndarray:
    return np.full(BEARINGS.shape, np.inf)


def test_open_space_leads_to_a_goal_sooner_or_later_straight_ahead() -> None:
    driver = wander()
    x = y = yaw = 0.0
    for step in range(400):
        twist = driver.command(Observation(step * PERIOD_NS, x, y, yaw, open_space().astype(np.float32)))
        yaw += twist.angular * 0.05
        x, y = x + twist.linear * 0.05 * math.cos(yaw), y + twist.linear * 0.05 * math.sin(yaw)
    assert math.hypot(x, y) > 3.0


@pytest.mark.parametrize("nearest", [0.3, -np.inf])
def test_wall_right_ahead_turns_the_rover_in_place(nearest: float) -> None:
    ranges = open_space()
    ranges[np.abs(BEARINGS) < 0.5] = nearest
    twist = wander().command(seen(ranges=ranges))
    assert twist.linear == 0.0
    assert abs(twist.angular) > 0.5


def test_blocked_left_side_turns_right() -> None:
    ranges = open_space()
    ranges[(BEARINGS > -0.3) & (BEARINGS < 2.8)] = 0.4
    assert wander().command(seen(ranges=ranges)).angular < 0


def test_obstacle_beside_the_track_does_not_stop_the_rover() -> None:
    ranges = open_space()
    ranges[np.abs(np.abs(BEARINGS) - math.pi / 2) < 0.2] = 0.5
    clear = wander(3).command(seen(ranges=open_space()))
    beside = wander(3).command(seen(ranges=ranges))
    assert math.copysign(1, beside.angular) == math.copysign(1, clear.angular)


def test_rover_that_makes_no_progress_backs_out_and_then_goes_on() -> None:
    driver = wander()
    steps = (STUCK_AFTER_NS + BACK_OUT_NS) // PERIOD_NS + 10
    commands = [driver.command(seen(n * PERIOD_NS, ranges=open_space())) for n in range(steps)]
    backwards = [twist.linear < 0 for twist in commands]
    assert not any(backwards[: STUCK_AFTER_NS // PERIOD_NS])
    assert sum(backwards) == BACK_OUT_NS // PERIOD_NS
    assert not backwards[-1]


def test_rover_near_the_edge_heads_for_the_middle() -> None:
    driver = wander()
    twist = driver.command(seen(x=18.5, y=0.1, ranges=open_space()))
    assert abs(twist.angular) > 0.5  # the middle is right behind: turn around


def test_same_generator_gives_the_same_commands() -> None:
    observations = [seen(step * PERIOD_NS, x=0.02 * step) for step in range(200)]
    one, two, other = wander(1), wander(1), wander(2)
    first = [one.command(o) for o in observations]
    assert first == [two.command(o) for o in observations]
    assert first != [other.command(o) for o in observations]
