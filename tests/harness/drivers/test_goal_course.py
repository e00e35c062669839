"""One goal after another."""

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.drivers.goal_course import GoalCourse
from harness.world.actors.free_space import FreeSpace
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
POST = Obstacle(ObstacleKind.HAZARD, "cylinder", (1.5, 0.5), (1.0, 0.0, 0.5))
SPACE = FreeSpace(Heightfield(np.zeros((81, 81)), 0.1), (POST,))


def course(area: tuple[float, float, float, float]) -> GoalCourse:
    return GoalCourse(area, SPACE, 0.3, np.random.default_rng(0))


def test_the_next_goal_comes_when_one_is_reached_or_given_up() -> None:
    made = course((-1.0, 2.0, -1.0, 3.0))
    first = made.next(0.0, (9.0, 9.0), UPRIGHT)
    assert first is not None
    assert made.next(0.05, (9.0, 9.0), UPRIGHT) is None
    second = made.next(10.0, (first.x, first.y + 0.29), UPRIGHT)
    assert second not in (None, first)
    assert made.next(217.0, (9.0, 9.0), UPRIGHT) is None
    assert made.next(217.05, (9.0, 9.0), UPRIGHT) is not None
    goals = np.array([(goal.x, goal.y) for goal in (made.draw() for _ in range(100))])
    assert (np.abs(goals - (0.5, 1.0)) <= (1.5, 2.0)).all()
    assert np.linalg.norm(goals - (1.0, 0.0), axis=1).min() >= 1.8 - 0.02  # the outline is a polygon
    assert course((-1.0, 2.0, -1.0, 3.0)).next(0.0, (9.0, 9.0), UPRIGHT) == first


@pytest.mark.parametrize(
    ("area", "mend"),
    [
        ((0.5, 1.5, -0.5, 0.5), "no free place in the goal area"),
        ((-1.0, 4.1, -1.0, 1.0), "reaches beyond the map, x -4 to 4, y -4 to 4 m"),
        ((-1.7e308, 1.7e308, -1.0, 1.0), "reaches beyond the map"),
    ],
)
def test_an_area_without_a_free_place_or_beyond_the_map_is_refused(
    area: tuple[float, float, float, float], mend: str
) -> None:
    with pytest.raises(UsageError, match=mend):
        course(area).draw()
