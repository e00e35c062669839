"""What an environment is made with, as values: worlds, rover, noise, randomisation, curriculum.

Every value may be given as Python has it or as JSON gives it back, so that a spec can be written to a
file: lists for tuples, mappings for the dataclasses in them, one number for a range of one.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, is_dataclass
from typing import TypeVar

from harness.base.errors import UsageError
from harness.base.sim_time import check_duration
from harness.episode.assembly import check
from harness.spec.rover import LIDAR_BEAMS
from harness.spec.run import Run
from harness.spec.world import DEFAULT_DIFFICULTY, FILE_FIELDS
from harness.world.terrain_file import is_terrain_file
from harness.yaml_file import fill

Range = tuple[float, float]
ONE: Range = (1.0, 1.0)
NONE: Range = (0.0, 0.0)
ONE_NUMBER = ("terrain_height", "terrain_cell", "rock_height")  # lists of one, empty if left out

O = TypeVar("O", bound="Options")  # noqa: E741 - options


@dataclass(frozen=True, kw_only=True)
class Randomisation:
    """Between what the rover varies from episode to episode, evenly distributed; by default not at all.

    Attributes:
        friction: Factor on the sliding friction of everything of the rover.
        mass: Factor on all masses and inertias.
        payload: Mass at the body's centre of mass [kg].
        motor_strength: Factor on the largest torque of the motors.
        latency: Age of what is observed [s], in whole control periods of 0.05 s.
    """

    friction: Range = ONE
    mass: Range = ONE
    payload: Range = NONE
    motor_strength: Range = ONE
    latency: Range = NONE


@dataclass(frozen=True, kw_only=True)
class Curriculum:
    """Worlds that get harder while episodes succeed; the range of difficulties is then its bounds.

    Attributes:
        step: By how much a new world is harder after a window of successes, or easier after one of
            failures; 0 for no curriculum.
        window: Episodes that are counted before difficulty may change.
        success: Share of them that makes it harder; half of that makes it easier.
    """

    step: float = 0.0
    window: int = 20
    success: float = 0.8

    def check(self) -> None:
        """Checks the numbers.

        Raises:
            UsageError: One is not valid.
        """
        if self.window < 1:
            raise UsageError(f"curriculum: window {self.window} is not valid; give 1 or more")
        for name in ("step", "success"):
            value = getattr(self, name)
            if not 0.0 <= value <= 1.0:
                raise UsageError(f"curriculum: {name} {value:g} is not valid; give 0 to 1")


@dataclass(frozen=True, kw_only=True)
class Options:
    """What all environments understand.

    Attributes:
        robot: Which rover.
        terrain: Names of terrains, or files; each new world is of one of them.
        terrain_size: Of heightmaps that do not say: length along x and y, or of both [m].
        terrain_height: Likewise, from the lowest to the highest point [m].
        terrain_cell: Distance of the heights that meshes become [m].
        resource_path: Folders in which models and meshes of SDF worlds are looked for first.
        mesh_unit: Of meshes that do not say it, e.g. cm.
        mesh_up: Their axis that is up, likewise.
        rock_height: Up to which obstacles of files are rocks [m]; empty: the rover's clearance.
        rock: Patterns of names of models that are rocks whatever their height.
        hazard: Likewise of hazards.
        difficulty: Of the worlds, 0 to 1; of named terrains.
        noise: A preset of sensor errors; "" for exact sensors.
        lidar_beams: Beams of the lidar, all around.
        time_limit: Of an episode [s].
        episodes_per_world: Episodes until a new world is made; a reset with a seed makes one at once.
        random_start: Whether an episode starts anywhere that can be reached, heading anywhere; else
            where `harness.run` starts.
        goal_distance: From the start to the goal, as the crow flies [m].
        randomisation: What varies of the rover.
        curriculum: How the worlds' difficulty follows success.
    """

    robot: str = "leo"
    terrain: tuple[str, ...] = ("rocky",)
    terrain_size: tuple[float, ...] = ()
    terrain_height: tuple[float, ...] = ()
    terrain_cell: tuple[float, ...] = ()
    resource_path: tuple[str, ...] = ()
    mesh_unit: str = ""
    mesh_up: str = ""
    rock_height: tuple[float, ...] = ()
    rock: tuple[str, ...] = ()
    hazard: tuple[str, ...] = ()
    difficulty: Range = (DEFAULT_DIFFICULTY, DEFAULT_DIFFICULTY)
    noise: str = ""
    lidar_beams: int = LIDAR_BEAMS
    time_limit: float = 60.0
    episodes_per_world: int = 10
    random_start: bool = True
    goal_distance: Range = (3.0, 10.0)
    randomisation: Randomisation = field(default_factory=Randomisation)
    curriculum: Curriculum = field(default_factory=Curriculum)

    def episode(self, terrain: str, seed: int, difficulty: float) -> Run:
        """Returns the episode of `harness.run` whose world, rover and noise these are.

        Args:
            terrain: One of `terrain`.
            seed: Of the world and of the noise.
            difficulty: Of the world; a file has none.
        """
        is_file = is_terrain_file(terrain)
        told = {name: value for name in FILE_FIELDS if is_file and (value := getattr(self, name))}
        told |= {name: told[name][0] for name in ONE_NUMBER if name in told}
        told |= {name: (told[name][0], told[name][-1]) for name in ("terrain_size",) if name in told}
        return Run.of(
            **told,
            terrain=terrain,
            robot=self.robot,
            seed=seed,
            difficulty=DEFAULT_DIFFICULTY if is_file else difficulty,
            noise=self.noise or None,
            lidar_beams=self.lidar_beams,
        )

    def check(self) -> None:
        """Checks every value that can be checked without building a world.

        Raises:
            UsageError: A value is not valid; the message names those that are.
        """
        self._check_worlds()
        check_duration(self.time_limit)
        for name in ("friction", "mass", "motor_strength"):
            _check_range(f"randomisation: {name}", getattr(self.randomisation, name), positive=True)
        for name in ("payload", "latency"):
            _check_range(f"randomisation: {name}", getattr(self.randomisation, name))
        _check_range("goal_distance", self.goal_distance, positive=True)
        self.curriculum.check()

    def _check_worlds(self) -> None:
        if not self.terrain:
            raise UsageError("terrain [] is empty; name at least one terrain or file")
        for terrain in self.terrain:
            for difficulty in self.difficulty:
                check(self.episode(terrain, 0, difficulty))
        for name, most in (("terrain_size", 2), *((name, 1) for name in ONE_NUMBER)):
            if len(getattr(self, name)) > most:
                raise UsageError(f"{name} {list(getattr(self, name))} is not valid; give {most} at most")
        _check_range("difficulty", self.difficulty)
        if self.episodes_per_world < 1:
            raise UsageError(
                f"episodes_per_world {self.episodes_per_world} is not valid; give 1 or more"
            )


def parse_options(cls: type[O], given: Mapping[str, object], where: str) -> O:
    """Returns checked options.

    Args:
        cls: The options of an environment.
        given: Its fields by name; those that are left out have their defaults.
        where: Whose they are, for the message.

    Raises:
        UsageError: One does not exist or is not valid.
    """
    values = {name: _plain(value) for name, value in given.items()}
    for name in ("terrain", "terrain_size", *ONE_NUMBER, "resource_path", "rock", "hazard"):
        if isinstance(values.get(name), str | float | int):
            values[name] = [values[name]]
    for name in ("difficulty", "goal_distance"):
        if isinstance(number := values.get(name), int | float):
            values[name] = [number, number]
    options = fill(cls, values, where)
    options.check()
    return options


def _plain(value: object) -> object:
    """The value as JSON has it; what JSON has not stays, and is refused later."""
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return list(value) if isinstance(value, tuple) else value


def _check_range(name: str, values: Range, *, positive: bool = False) -> None:
    low, high = values
    least = "above 0" if positive else "from 0 up"
    if not (math.isfinite(high) and low <= high and (low > 0.0 if positive else low >= 0.0)):
        raise UsageError(
            f"{name} {low:g} to {high:g} is not valid; give two numbers {least}, the lower first"
        )
