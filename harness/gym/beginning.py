"""How an episode of an environment begins: the world that is drawn, a place to stand."""

from collections.abc import Callable, Mapping
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from harness.base.errors import RunFailed, UsageError
from harness.gym.course import Course, Variation
from harness.gym.driven_rover import DrivenRover
from harness.gym.options import CurriculumSchedule, Options
from harness.spec.value import Finite, Value, as_tuple, made
from harness.world.world import Start

MOST_TRIES = 20  # places at which a start is tried: a few are too steep to stand on
OF_A_WORLD = ("terrain", "world_seed", "difficulty", "soil")  # fields of ResetOptions


class ResetOptions(Value):
    """What the options of a reset may ask for.

    Attributes:
        terrain: Name or file of a new world.
        difficulty: Difficulty of a new world, 0 to 1.
        world_seed: Seed of a new world.
        soil: Soil of a new world, "" for rigid ground.
        start: x, y [m] and yaw [rad] in the world.
        goal: x, y in the world [m].
    """

    terrain: str | None = None
    difficulty: float | None = None
    world_seed: int | None = None
    soil: str | None = None
    start: Annotated[tuple[Finite, ...] | None, Field(min_length=3, max_length=3)] = None
    goal: Annotated[tuple[Finite, ...] | None, Field(min_length=2, max_length=2)] = None


def reset_options(given: Mapping[str, object]) -> dict[str, Any]:
    """Returns what the options of a reset ask for, by fields of ResetOptions, or a UsageError."""
    values = {name: _plain(value) for name, value in given.items()}
    return made(ResetOptions, values, "reset").model_dump(exclude_none=True)


def _plain(value: object) -> object:
    """Numbers of numpy, as the info of a reset has them, as numbers of Python."""
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else as_tuple(value)


def drawn_world(
    options: Options, schedule: CurriculumSchedule, rng: np.random.Generator, seed: int
) -> dict[str, Any]:
    """Returns terrain, seed, difficulty and soil of a new world, by the fields of ResetOptions.

    Args:
        options: Between what to choose.
        schedule: Of the difficulty.
        rng: What is drawn from.
        seed: Of the world.
    """
    terrain = options.terrain[int(rng.integers(len(options.terrain)))]
    difficulty = schedule.draw(rng)
    soils = options.soil
    soil = soils[int(rng.integers(len(soils)))] if len(soils) > 1 else soils[0]
    return {"terrain": terrain, "world_seed": seed, "difficulty": difficulty, "soil": soil}


def started(
    course: Course, draw: Callable[[], Start], variation: Variation, noise_seed: int
) -> DrivenRover:
    """Returns the rover at the first drawn place where it can stand; UsageError if there is none.

    Args:
        course: The world.
        draw: Draws a place: x, y [m] and yaw [rad].
        variation: Of the rover.
        noise_seed: Of its sensors' noise.
    """
    reasons = set()
    for _ in range(MOST_TRIES):
        try:
            return DrivenRover(course, draw(), variation, noise_seed)
        except (UsageError, RunFailed) as error:  # noqa: PERF203 - another start is tried
            reasons.add(str(error))
    if len(reasons) == 1:  # it is not the place
        raise UsageError(reasons.pop())
    raise UsageError(
        f"no start was found on {course.run.world.terrain}, seed {course.run.seed}, in {MOST_TRIES} "
        "tries; choose an easier world, or random_start=False"
    )
