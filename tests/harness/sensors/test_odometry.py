"""Wheel odometry against closed forms: the wheels are turned by hand, whole counts at a time."""

import math
from collections.abc import Callable

import pytest

from harness.physics.simulation import Simulation
from harness.robots import ROVERS, RoverSpec
from harness.sensors.odometry import WheelOdometry
from tests.support.rovers import LEO, ROVER_ZERO4WD

BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
BELIEVED = {
    LEO.name: (0.0625, 0.358, 878.4),
    ROVER_ZERO4WD.name: (0.122, 0.24, 4096.0),
    "husky": (0.1651, 1.07025, 80000.0),
    "jackal": (0.098, 0.563385, 80000.0),
}


MakeSimulation = Callable[[RoverSpec], Simulation]
MakeBench = Callable[..., "Bench"]


class Bench:
    """A rover whose wheels are turned to so many counts; half a count more, to be clear of edges."""

    def __init__(self, simulation: Simulation, rover: RoverSpec, period_ticks: int = 5) -> None:
        self._simulation, self._rover = simulation, rover
        self.radius, self.separation, self.resolution = BELIEVED[rover.name]
        self.count = math.tau * self.radius / self.resolution  # [m]
        self.turn_to(123.0, -45.0, 6.0, 789.0)
        self.odometry = WheelOdometry(simulation, period_ticks)
        self.turned = [123.0, -45.0, 6.0, 789.0]

    def turn_to(self, *counts: float) -> None:
        for name, count in zip(self._rover.wheel_joints, counts, strict=True):
            angle = (count + 0.5) * math.tau / self.resolution
            self._simulation.data.joint(name).qpos[0] = angle

    def turn_by(self, *steps: float) -> None:
        """Front left, rear left, front right, rear right."""
        self.turned = [before + step for before, step in zip(self.turned, steps, strict=True)]
        self.turn_to(*self.turned)


@pytest.fixture
def bench(simulate: MakeSimulation) -> MakeBench:
    return lambda rover, period_ticks=5: Bench(simulate(rover), rover, period_ticks)


@BOTH
@pytest.mark.parametrize(
    ("left", "right", "period_ticks"),
    [(40, 50, 5), (-30, -37, 2), (60, -60, 5), (0, 7, 1)],
    ids=["left arc", "backwards", "turn right in place", "one side"],
)
def test_an_arc_is_a_polygon_in_the_circle_whose_sides_leave_at_half_the_turn(
    rover: RoverSpec, left: int, right: int, period_ticks: int, bench: MakeBench
) -> None:
    """Sums of cos and sin of (k + 1/2) a, as geometric series; the ends lie on the true circle."""
    rig = bench(rover, period_ticks)
    finer = max(1, round(rig.resolution / 1300))
    left, right = finer * left, finer * right
    distance = (left + right) / 2 * rig.count
    turn = (right - left) * rig.count / rig.separation
    readings = 200
    for _ in range(readings):
        rig.turn_by(left + 3, left - 3, right - 2, right + 2)  # a side's two wheels differ
        reading = rig.odometry.read()
    angle = readings * turn
    assert abs(angle) > math.pi / 4
    x = distance * math.sin(angle) / (2 * math.sin(turn / 2))
    y = distance * (1 - math.cos(angle)) / (2 * math.sin(turn / 2))
    assert (reading.x, reading.y) == pytest.approx((x, y), abs=1e-9)
    assert -math.pi <= reading.yaw <= math.pi
    assert math.remainder(reading.yaw - angle, math.tau) == pytest.approx(0.0, abs=1e-9)
    radius = distance / turn
    circle = radius * math.sin(angle), radius * (1 - math.cos(angle))
    assert (reading.x, reading.y) == pytest.approx(circle, abs=1e-12 + turn**2 * abs(radius))
    period = period_ticks * 0.01
    expected = pytest.approx((distance / period, turn / period))
    assert (reading.twist.linear, reading.twist.angular) == expected


def test_wheels_put_elsewhere_are_taken_for_unmoved_time_after_time(bench: MakeBench) -> None:
    rig = bench(ROVER_ZERO4WD)
    rig.turn_by(100, 100, 120, 120)
    before = rig.odometry.read()
    rig.turn_by(*[30] * 4)  # not read yet: they are not forgotten
    for elsewhere in ((5.0, -7000.0, 11.0, 300.0), (0.0, 0.0, 0.0, 0.0)):
        rig.odometry.before_reset()
        rig.turned = list(elsewhere)
        rig.turn_by(0, 0, 0, 0)
        rig.odometry.after_reset()
        moved = rig.odometry.read()
        way = math.hypot(moved.x - before.x, moved.y - before.y)
        assert way == pytest.approx(30 * rig.count)
        assert moved.yaw == before.yaw


def test_six_wheels_count_as_the_means_of_their_sides_and_one_without_a_motor_does_not(
    foreign: Callable[[str], RoverSpec], simulate: MakeSimulation
) -> None:
    rover, count = foreign("sojourner"), math.tau / 4096
    driven = rover.wheel_joints[:2] + rover.wheel_joints[3:5]
    for spec, left, right in (
        (rover, 200 * count, 600 * count),
        (rover.but(drive=rover.drive.but(driven=driven)), 150 * count, 550 * count),
    ):
        simulation = simulate(spec)
        for name in rover.wheel_joints:
            simulation.data.joint(name).qpos[0] = count / 2
        odometry = WheelOdometry(simulation, 5)
        for name, counts in zip(rover.wheel_joints, (100, 200, 300, 500, 600, 700), strict=True):
            simulation.data.joint(name).qpos[0] += counts * count
        reading = odometry.read()
        turn, way = (right - left) * 0.065 / 0.4, 0.065 * (left + right) / 2
        expected = (way * math.cos(turn / 2), way * math.sin(turn / 2), turn)
        assert (reading.x, reading.y, reading.yaw) == pytest.approx(expected)


def test_steered_wheels_tell_the_curve_and_the_others_the_way(
    foreign: Callable[[str], RoverSpec], simulate: MakeSimulation
) -> None:
    """Along a circle of 2 m about a centre on the rear axle's line, each wheel as the circle says."""
    rover = foreign("buggy").but(track=0.3)  # its controller has a separation of its own
    simulation, radius, arc = simulate(rover), 2.0, 0.3
    half, length = 0.2413 / 2, 0.3302
    for name, aside in (("left_steering", half), ("right_steering", -half)):
        simulation.data.joint(name).qpos[0] = math.atan2(length, radius - aside)
    odometry = WheelOdometry(simulation, 5)
    for name, aside in (("rear_left_joint", half), ("rear_right_joint", -half)):
        simulation.data.joint(name).qpos[0] += arc * (radius - aside) / 0.0508
    reading = odometry.read()
    assert reading.yaw == pytest.approx(arc, abs=2e-3)  # counts of 0.08 mm
    way = arc * radius  # along the mean heading, as all wheel odometry of the house
    assert (reading.x, reading.y) == pytest.approx(
        (way * math.cos(arc / 2), way * math.sin(arc / 2)), abs=5e-4
    )
