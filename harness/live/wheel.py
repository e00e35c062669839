"""Who drives a rover of a page: the run's own driver, keys that are held, or a goal that was clicked."""

import math
import time
from collections.abc import Callable

from harness.drivers import takes_goals
from harness.drivers.base import drivable
from harness.episode.helm import BY_HAND, Helm, Order
from harness.robots import find_rover
from harness.samples import Place, Twist, Vector3
from harness.spec.rover import RoverSetup

GOAL = "goal"  # the driver that goes where it is told
# Wall time for which a key counts [s]: a keyboard takes up to 0.5 s until it repeats one that is held.
HELD = 0.7


class Wheel:
    """Turns keys and clicks into orders to one rover.

    A key holds for HELD after it was pressed last, a second one keeps the first alive: who lets go, or
    closes the page, lets the rover stop.

    Args:
        helm: Gets the orders.
        number: The rover's place in the run.
        rover: Its setup.
        clock: Monotonic wall clock [s].
    """

    def __init__(
        self, helm: Helm, number: int, rover: RoverSetup, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._helm, self._number, self._clock = helm, number, clock
        self._rover, self._own = find_rover(rover.robot), rover.driver
        self._driver = ""  # whom the rover was handed to
        self._forward = self._left = 0.0  # of what is pressed, from -1 to 1
        self._until: float | None = None  # when that ends

    def press(self, *, forward: float = 0.0, left: float = 0.0) -> None:
        """Takes a key, as a share of the cruising speed or of its yaw rate."""
        self._until = self._clock() + HELD
        self._turn(forward or self._forward, left or self._left)

    def let_go(self) -> None:
        """Stops the rover when no key was pressed for a while; to be called again and again."""
        if self._until is not None and self._clock() >= self._until:
            self._until = None
            self._turn(0.0, 0.0)

    def head_for(self, x: float, y: float, of: Vector3) -> Place:
        """Sends the rover to a place, along the line from where it is [m]; returns the goal."""
        goal = Place(x, y, math.atan2(y - of[1], x - of[0]))
        own = takes_goals(self._own) and not self._driver
        self._until, self._forward, self._left = None, 0.0, 0.0
        self._order(Order(driver=self._handed("" if own else GOAL), goal=goal))
        return goal

    def give_back(self) -> None:
        """Lets the run's own driver drive."""
        self._until = None
        self._order(Order(driver=self._handed("")))

    def reset(self) -> None:
        """Puts the rover back to its start, where its own driver begins anew."""
        self._until, self._driver = None, ""
        self._forward = self._left = 0.0
        self._order(Order(reset=True))

    def _turn(self, forward: float, left: float) -> None:
        if (forward, left) == (self._forward, self._left) and self._driver == self._by_hand:
            return
        self._forward, self._left = forward, left
        twist = Twist(forward * self._rover.cruise_speed, left * self._rover.cruise_yaw_rate)
        order = Order(driver=self._handed(self._by_hand), command=drivable(twist, self._rover))
        self._order(order)

    @property
    def _by_hand(self) -> str:
        return "" if self._own == BY_HAND else BY_HAND

    def _handed(self, driver: str) -> str | None:
        """The driver to hand over to; None if it drives already."""
        before, self._driver = self._driver, driver
        return None if before == driver else driver

    def _order(self, order: Order) -> None:
        if order != Order():
            self._helm.order(self._number, order)
