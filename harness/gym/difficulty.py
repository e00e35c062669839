"""How difficult the next world is: drawn from a range, whose upper end a curriculum moves."""

import numpy as np

from harness.gym.options import Curriculum, Range


class CurriculumSchedule:
    """Draws difficulties from a range, whose upper end rises while episodes succeed.

    Attributes:
        highest: Largest difficulty of the next world; without a curriculum the upper end of the range.
    """

    def __init__(self, curriculum: Curriculum, bounds: Range) -> None:
        self._curriculum, self._bounds = curriculum, bounds
        self.highest = bounds[0] if curriculum.step else bounds[1]
        self._successes: list[bool] = []

    def draw(self, rng: np.random.Generator) -> float:
        """Returns the difficulty of the next world."""
        return float(rng.uniform(self._bounds[0], self.highest))

    def record(self, *, success: bool) -> None:
        """Counts an episode; after a window of them, goes up, goes down or stays."""
        self._successes.append(success)
        if len(self._successes) < self._curriculum.window:
            return
        share, wanted = sum(self._successes) / len(self._successes), self._curriculum.success
        self._successes.clear()
        rise = (share >= wanted) - (share < wanted / 2)
        low, high = self._bounds
        self.highest = min(high, max(low, self.highest + rise * self._curriculum.step))
