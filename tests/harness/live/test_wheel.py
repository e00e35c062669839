"""Who drives a rover of a page: what keys and clicks order."""

import math

from harness.base.interrupt import StopRequest
from harness.episode.helm import Helm, Order
from harness.live.keys import HELD, STANDING, Keys
from harness.live.wheel import Wheel
from harness.samples import Place, Twist
from harness.spec.rover import RoverSetup
from tests.support.rovers import LEO


class Told(Helm):
    """A helm that keeps what is ordered."""

    def __init__(self) -> None:
        super().__init__(None, StopRequest())
        self.orders: list[Order] = []

    def order(self, number: int, order: Order) -> None:
        assert number == 0
        self.orders.append(order)


def test_each_grip_takes_the_wheel_for_somebody_else_may_have_it_since() -> None:
    now, helm = [0.0], Told()
    wheel = Wheel(helm, 0, RoverSetup(robot="leo"), Keys(lambda: now[0]))
    for _ in range(2):  # between them a plan or a service puts the rover back, of which nobody tells
        wheel.press(1.0, -1.0)
        now[0] += HELD + 0.1
        wheel.let_go()
        wheel.let_go()
    drive, stop, *again = helm.orders
    assert (drive.driver, stop.driver, drive.held) == ("cmd_vel", None, True)
    assert drive.command == Twist(LEO.cruise_speed, -LEO.cruise_yaw_rate)
    assert stop.command == Twist()
    assert again == [drive, stop]


def test_a_key_of_turning_goes_with_one_of_driving_as_long_as_either_is_held() -> None:
    now = [0.0]
    keys = Keys(lambda: now[0])
    for forward, left, both in (
        (1.0, 0.0, (1.0, 0.0)),
        (0.0, 1.0, (1.0, 1.0)),
        (-1.0, 0.0, (-1.0, 1.0)),
    ):
        keys.press(forward, left)
        now[0] += 0.9 * HELD
        assert keys.share == both
    now[0] += 0.2 * HELD
    assert keys.share == STANDING


def test_a_click_sends_it_there_and_who_gives_back_lets_it_drive_by_itself() -> None:
    helm = Told()
    wheel = Wheel(helm, 0, RoverSetup(robot="leo"))
    goal = wheel.head_for(2.0, -3.0, (4.0, -1.0, 0.0))
    wheel.give_back()
    wheel.reset()
    assert goal == Place(2.0, -3.0, -0.75 * math.pi)
    sent, given, back = helm.orders
    assert (sent.driver, sent.goal) == ("goal", goal)
    assert (given, back) == (Order(driver=""), Order(reset=True))
