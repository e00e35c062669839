"""Keys that are held to drive, where nobody tells when one is let go."""

import time
from collections.abc import Callable

# Wall time for which a key counts [s]: a keyboard takes up to 0.5 s until it repeats one that is held.
HELD = 0.7
STANDING = (0.0, 0.0)
# By key: what it does, its share of full speed forwards, and of full yaw rate to the left.
DIRECTIONS = {
    "I": ("forwards", 1.0, 0.0),
    "K": ("backwards", -1.0, 0.0),
    "J": ("to the left", 0.0, 1.0),
    "L": ("to the right", 0.0, -1.0),
}


class Keys:
    """What is pressed, by a monotonic clock [s]: a key counts for HELD, and keeps others alive."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._share = clock, STANDING
        self._until = -float("inf")

    def press(self, forward: float, left: float) -> None:
        """Takes a key by its shares; 0 leaves the other one as it is."""
        before = self.share
        self._share = (forward or before[0], left or before[1])
        self._until = self._clock() + HELD

    def forget(self) -> None:
        """Lets go of all."""
        self._share = STANDING

    @property
    def share(self) -> tuple[float, float]:
        """The present shares of full speed forwards and of full yaw rate to the left."""
        return self._share if self._clock() < self._until else STANDING
