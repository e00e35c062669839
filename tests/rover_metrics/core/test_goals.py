"""Goals by the collector's rule: reached within 0.3 m, given up after 207 s or lying on a side."""

import math

import pytest
from scipy.spatial.transform import Rotation

from rover_metrics.core.goals import GoalAccount
from rover_metrics.core.rotation import Quaternion

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def leaning(axis: str, angle: float) -> Quaternion:
    x, y, z, w = Rotation.from_euler(axis, angle).as_quat().tolist()
    return x, y, z, w


@pytest.mark.parametrize(
    ("time_s", "place", "orientation", "counts"),
    [
        (11.0, (1.0, 2.2999), UPRIGHT, (1, 0)),
        (11.0, (1.0, 2.3001), UPRIGHT, (0, 0)),
        (217.0, (5.0, 5.0), UPRIGHT, (0, 0)),
        (217.01, (5.0, 5.0), UPRIGHT, (0, 1)),
        (217.01, (1.0, 2.0), UPRIGHT, (1, 0)),
        *((11.0, (1.0, 2.0), leaning(axis, sign * 1.49), (0, 1)) for axis in "xy" for sign in (1, -1)),
        *((11.0, (5.0, 5.0), leaning(axis, 1.47), (0, 0)) for axis in "xyz"),
    ],
)
def test_a_goal_is_settled_once(
    time_s: float, place: tuple[float, float], orientation: Quaternion, counts: tuple[int, int]
) -> None:
    account = GoalAccount()
    account.observe(0.0, (1.0, 2.0), UPRIGHT)  # before there is one
    account.begin((1.0, 2.0), 10.0)
    for _ in range(2):
        account.observe(time_s, place, orientation)
        assert (account.reached, account.failed) == counts
    assert account.goal == (None if any(counts) else (1.0, 2.0))


def test_a_new_goal_has_its_own_time_and_the_old_one_counts_as_nothing() -> None:
    account = GoalAccount()
    account.begin((1.0, 2.0), 0.0)
    account.begin((3.0, 4.0), 100.0)
    account.observe(250.0, (1.0, 2.0), UPRIGHT)
    assert (account.reached, account.failed, account.goal) == (0, 0, (3.0, 4.0))
    account.observe(251.0, (3.0, 4.0 - 0.1), leaning("z", math.pi))
    assert account.reached == 1
