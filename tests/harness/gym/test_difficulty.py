import numpy as np
import pytest

from harness.gym.options import Curriculum, CurriculumSchedule


def test_without_a_curriculum_the_whole_range_is_drawn_from_whatever_succeeds() -> None:
    ladder, rng = CurriculumSchedule(Curriculum(window=1), (0.2, 0.6)), np.random.default_rng(0)
    ladder.record(success=False)
    draws = [ladder.draw(rng) for _ in range(100)]
    assert 0.2 <= min(draws) < 0.22
    assert 0.58 < max(draws) <= 0.6


@pytest.mark.parametrize(
    ("share", "windows", "highest"),
    [
        (0.75, [3], 0.5),  # three of four are enough
        (0.75, [4, 4], 0.8),
        (0.75, [4, 4, 4], 0.9),  # not beyond the range
        (0.75, [4, 4, 2], 0.8),  # half of the wanted share is 1.5: it stays
        (0.75, [4, 4, 1], 0.5),
        (0.75, [0, 0], 0.2),  # not below it
        (0.5, [4, 2], 0.8),  # all that is wanted is harder
        (0.5, [4, 4, 1], 0.8),  # half of it is not yet easier
        (0.5, [4, 4, 0], 0.5),
    ],
)
def test_a_window_of_episodes_moves_the_upper_end(
    share: float, windows: list[int], highest: float
) -> None:
    ladder = CurriculumSchedule(Curriculum(step=0.3, window=4, success=share), (0.2, 0.9))
    for successes in windows:
        for episode in range(4):
            ladder.record(success=episode < successes)
    assert ladder.highest == pytest.approx(highest)
    assert 0.2 <= ladder.draw(np.random.default_rng(1)) <= highest
