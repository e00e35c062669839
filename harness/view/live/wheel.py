"""Who drives a rover of a page: the run's own driver, keys that are held, or a goal that was clicked."""

import math
from threading import RLock

from harness.drivers import takes_goals
from harness.drivers.base import drivable
from harness.episode.helm import Helm, Order
from harness.robots import find_rover
from harness.samples import Place, Twist, Vector3
from harness.spec.rover import CMD_VEL, RoverSetup
from harness.view.live.keys import STANDING, Keys

GOAL = "goal"  # the driver that goes to goals


class Wheel:
    """Turns keys and clicks into orders to one rover; who lets go, or closes the page, lets it stop.

    Args:
        helm: Gets the orders.
        number: The rover's place in the run.
        rover: Its setup.
        keys: What is pressed.
    """

    def __init__(self, helm: Helm, number: int, rover: RoverSetup, keys: Keys | None = None) -> None:
        self._helm, self._number, self._keys = helm, number, keys or Keys()
        self._rover, self._own = find_rover(rover.robot), rover.driver
        self._driver: str | None = ""  # whom the rover was handed to; None where others may have since
        self._lock = RLock()  # keys and clicks come from other threads than `let_go`
        self._turned = STANDING

    def press(self, forward: float, left: float) -> None:
        """Takes a key, as shares of the cruising speed and of its yaw rate."""
        with self._lock:
            if self._keys.share == STANDING:
                self._driver = None
            self._keys.press(forward, left)
            self._turn(first=self._driver != self._by_hand)

    def let_go(self) -> None:
        """Stops the rover when no key was pressed for a while; to be called again and again."""
        with self._lock:
            self._turn()

    def head_for(self, x: float, y: float, of: Vector3) -> Place:
        """Sends the rover to a place; returns the goal, whose yaw is that of the line from the rover.

        Args:
            x: In the world [m].
            y: In the world [m].
            of: Where the rover is in the world [m].
        """
        goal = Place(x, y, math.atan2(y - of[1], x - of[0]))
        with self._lock:
            own = takes_goals(self._own) and not self._driver
            self._driver = self._driver if own else None
            self._hand_over("" if own else GOAL, Order(goal=goal))
        return goal

    def give_back(self) -> None:
        """Lets the run's own driver drive."""
        with self._lock:
            if self._turned != STANDING:  # it may be the run's own that holds the last command
                self._driver = None
            self._hand_over("", Order())

    def reset(self) -> None:
        """Puts the rover back to its start, where its own driver begins anew."""
        with self._lock:
            self._driver = ""
            self._hand_over("", Order(reset=True))

    def _turn(self, *, first: bool = False) -> None:
        if self._keys.share != self._turned or first:
            self._turned = forward, left = self._keys.share
            twist = Twist(forward * self._rover.cruise_speed, left * self._rover.cruise_yaw_rate)
            order = Order(command=drivable(twist, self._rover), held=True)
            self._helm.order(self._number, order._replace(driver=self._handed(self._by_hand)))

    def _hand_over(self, driver: str, order: Order) -> None:
        self._keys.forget()
        self._turned = STANDING
        order = order._replace(driver=self._handed(driver))
        if order != Order():
            self._helm.order(self._number, order)

    @property
    def _by_hand(self) -> str:
        return "" if self._own == CMD_VEL else CMD_VEL

    def _handed(self, driver: str) -> str | None:
        """The driver to hand over to; None if it drives already."""
        before, self._driver = self._driver, driver
        return None if before == driver else driver
