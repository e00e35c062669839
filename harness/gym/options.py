"""What an environment is made with, as values: worlds, rover, noise, randomisation, curriculum.

The fields of a run (harness.spec) are options too, ranges where a run has one number. Every value may be
given as Python has it or as JSON gives it back, so that a spec can be written to a file.
"""

from collections.abc import Mapping
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, create_model

from harness.base.sim_time import check_duration
from harness.episode.assembly import check
from harness.spec.run import Run, keys_of
from harness.spec.value import Finite, Length, Share, Value, as_tuple, checked, listed, made
from harness.spec.world import DEFAULT_DIFFICULTY, FILE_FIELDS
from harness.world.files import is_terrain_file

O = TypeVar("O", bound="Options")  # noqa: E741 - options


def _both_ends(value: object) -> object:
    """One number is a range of one."""
    return (value, value) if isinstance(value, int | float) else as_tuple(value)


def _in_order(bounds: tuple[float, float], info: ValidationInfo) -> tuple[float, float]:
    low, high = bounds
    if low > high:
        name = info.field_name
        raise ValueError(f"{name} {low:g} to {high:g} is not valid; give two numbers, the lower first")
    return bounds


def _single(value: object) -> object:
    """A list of one is its value, an empty one nothing, as in specs that were written before."""
    items = as_tuple(value)
    if not isinstance(items, tuple) or len(items) > 1:
        return items
    return items[0] if items else None


Positive = Annotated[tuple[Length, Length], AfterValidator(_in_order), BeforeValidator(_both_ends)]
Range = Annotated[
    tuple[Annotated[Finite, Field(ge=0.0)], Annotated[Finite, Field(ge=0.0)]],
    AfterValidator(_in_order),
    BeforeValidator(_both_ends),
]
Shares = Annotated[tuple[Share, Share], AfterValidator(_in_order), BeforeValidator(_both_ends)]
Terrains = Annotated[tuple[str, ...], Field(min_length=1), listed()]

if TYPE_CHECKING:

    class RunOptions(Value):
        """What a type checker knows of the fields of a run."""

        robot: str = ""
        lidar_beams: int = 0
        actuators: str = ""
        keep_ruts: bool = False
else:
    RunOptions = create_model(
        "RunOptions",
        __base__=Value,
        **keys_of(
            "robot", "actuators", "surface", "lidar_beams", "targets", "datum", "keep_ruts", *FILE_FIELDS
        ),
    )


class Randomisation(Value):
    """Ranges in which the rover varies from episode to episode, evenly distributed; by default none.

    Attributes:
        friction: Factor on the sliding friction of everything of the rover.
        mass: Factor on all masses and inertias.
        payload: Mass at the body's centre of mass [kg].
        motor_strength: Factor on the largest torque of the motors.
        latency: Age of what is observed [s], in whole control periods of 0.05 s.
        soil_stiffness: Factor on the moduli of soils.
        soil_friction: Factor on the tangent of their friction angles.
    """

    friction: Positive = (1.0, 1.0)
    mass: Positive = (1.0, 1.0)
    payload: Range = (0.0, 0.0)
    motor_strength: Positive = (1.0, 1.0)
    latency: Range = (0.0, 0.0)
    soil_stiffness: Positive = (1.0, 1.0)
    soil_friction: Positive = (1.0, 1.0)


class Curriculum(Value):
    """Worlds that get harder while episodes succeed; the range of difficulties is then its bounds.

    Attributes:
        step: By how much a new world is harder after a window of successes, or easier after one of
            failures; 0 for no curriculum.
        window: Episodes that are counted before difficulty may change.
        success: Share of them that makes it harder; half of that makes it easier.
    """

    step: Share = 0.0
    window: Annotated[int, Field(ge=1)] = 20
    success: Share = 0.8


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


class Options(RunOptions):
    """What all environments understand.

    Attributes:
        terrain: Names of terrains, or files; each new world is of one of them.
        difficulty: Of the worlds, 0 to 1; of named terrains.
        soil: As `harness.run --soil` takes it, "" for rigid ground; each new world has one of them.
        noise: A preset of sensor errors; "" for exact sensors.
        time_limit: Of an episode [s].
        episodes_per_world: Episodes until a new world is made; a reset with a seed makes one at once.
        random_start: Whether an episode starts anywhere that can be reached, heading anywhere; else
            where `harness.run` starts.
        goal_distance: From the start to the goal, as the crow flies [m].
        randomisation: What varies of the rover.
        curriculum: How the worlds' difficulty follows success.
        reward_fn: Gives the reward, or its terms by name, instead of the environment, of truth and
            action (harness.gym.custom); or the name of a plug-in, or FILE.py:FUNCTION.
        terminate_fn: Whether the episode ends too, of the truth; or the name of a plug-in, or
            FILE.py:FUNCTION.
        observe_fn: A further entry of the observation: a harness.gym.custom.Sight, or one by its name.
    """

    terrain: Terrains = ("rocky",)
    difficulty: Shares = (DEFAULT_DIFFICULTY, DEFAULT_DIFFICULTY)
    soil: Terrains = ("",)
    noise: str = ""
    time_limit: Annotated[float, AfterValidator(checked(partial(check_duration, name="time_limit")))] = (
        60.0
    )
    episodes_per_world: Annotated[int, Field(ge=1)] = 10
    random_start: bool = True
    goal_distance: Positive = (3.0, 10.0)
    randomisation: Randomisation = Randomisation()
    curriculum: Curriculum = Curriculum()
    reward_fn: Any = None
    terminate_fn: Any = None
    observe_fn: Any = None

    def episode(self, terrain: str, seed: int, difficulty: float, soil: str = "") -> Run:
        """Returns the run of `harness.run` whose world, rover and noise these are.

        Args:
            terrain: One of `terrain`.
            seed: Of the world and of the noise.
            difficulty: Of the world; a file has none.
            soil: One of `soil`.

        Raises:
            UsageError: A value is not valid for this terrain.
        """
        is_file = is_terrain_file(terrain)
        names = [name for name in RunOptions.model_fields if is_file or name not in FILE_FIELDS]
        given: dict[str, Any] = {name: getattr(self, name) for name in names}
        given |= {} if is_file else {"difficulty": difficulty}
        run = Run.of(**given, terrain=terrain, soil=soil, seed=seed, noise=self.noise or None)
        check(run)
        return run


def parse_options(cls: type[O], given: Mapping[str, object], where: str) -> O:
    """Returns checked options.

    Args:
        cls: The options of an environment.
        given: Its fields by name; those that are left out have their defaults.
        where: Whose they are, for the UsageError of one that does not exist or is not valid.
    """
    values = {name: _single(value) if name in FILE_FIELDS else value for name, value in given.items()}
    options = made(cls, {name: value for name, value in values.items() if value is not None}, where)
    for terrain, difficulty, soil in product(options.terrain, options.difficulty, options.soil):
        options.episode(terrain, 0, difficulty, soil)
    return options
