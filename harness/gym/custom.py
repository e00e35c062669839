"""Rewards, endings and observations of one's own: what their functions are given, and their tables."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.base.errors import UsageError, find_named
from harness.gym.observation import Part
from rover_metrics.core import rotation
from rover_metrics.plugins import Table, takes

if TYPE_CHECKING:
    from harness.gym.driven_rover import DrivenRover


@dataclass(frozen=True, kw_only=True)
class StepTruth:
    """What only the simulator knows after a step of 0.05 s.

    Attributes:
        time_s: Since the episode began [s].
        position: Of the rover's model frame in the world [m].
        yaw: Heading in the world [rad].
        tilt: Angle between the rover's and the world's vertical [rad].
        speed: Forwards [m/s].
        goal: Where to drive: x, y in the world [m].
        distance: To the goal, in the plane [m].
        progress: By how much nearer it has come in this step [m].
        hazard_s: Contact with hazards in this step [s].
        scrape_s: Contact of anything but wheels with the ground in this step [s].
        energy: Taken by the motors in this step [W h]; 0 of ideal servos.
        ending: Why the episode ends by the environment's own rules; "" if it does not.
    """

    time_s: float
    position: tuple[float, float, float]
    yaw: float
    tilt: float
    speed: float
    goal: tuple[float, float]
    distance: float
    progress: float
    hazard_s: float
    scrape_s: float
    energy: float
    ending: str


RewardFn = Callable[[StepTruth, NDArray[np.float32]], Mapping[str, float] | float]
TerminateFn = Callable[[StepTruth], bool]
OWN = "own"  # name of an ending and of an observation that have none


@dataclass(frozen=True)
class Sight:
    """A user's own entry of the observation.

    Attributes:
        low, high: Smallest and largest value of each number.
        of: The numbers after a step.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    of: Callable[[StepTruth], ArrayLike]

    def part(self, name: str) -> Part:
        """Returns what the space of observations has of it."""
        return Part(self.low, self.high, f"observed by {name}")


REWARDS = Table[RewardFn](
    "rewards",
    {},
    lambda value: takes(value, 2),
    "a function (truth, action) -> number, or terms by name",
)
ENDINGS = Table[TerminateFn]("endings", {}, lambda value: takes(value, 1), "a function (truth) -> bool")
OBSERVATIONS = Table[Sight](
    "observations",
    {},
    lambda value: isinstance(value, Sight) and takes(value.of, 1),
    "a harness.gym.custom.Sight with a function (truth) -> numbers",
)


def truth_of(
    driven: "DrivenRover", goal: tuple[float, float], time_s: float, before: float, ending: str
) -> StepTruth:
    """Returns the truth after a step.

    Args:
        driven: The rover.
        goal: Where it drives [m].
        time_s: Since the episode began [s].
        before: The distance to the goal before the step [m].
        ending: Why the episode ends by the environment's own rules; "" if it does not.
    """
    simulation = driven.simulation
    x, y, z = simulation.position
    distance = math.dist(goal, (x, y))
    return StepTruth(
        time_s=time_s,
        position=(x, y, z),
        yaw=rotation.yaw(simulation.orientation),
        tilt=rotation.tilt(simulation.orientation),
        speed=float(simulation.velocity[0]),
        goal=goal,
        distance=distance,
        progress=before - distance,
        hazard_s=driven.hazard_s,
        scrape_s=driven.scrape_s,
        energy=driven.energy,
        ending=ending,
    )


@dataclass(frozen=True)
class Own:
    """What a user makes of the steps of an environment.

    Attributes:
        reward: Gives the reward instead of the environment, or its terms; None leaves it.
        terminate: Whether the episode ends; None adds no ending.
        sights: Further entries of the observation, by name.
    """

    reward: RewardFn | None
    terminate: TerminateFn | None
    sights: Mapping[str, Sight]

    @property
    def needs_truth(self) -> bool:
        """Whether a step has to be looked at."""
        return bool(self.reward or self.terminate or self.sights)

    def seen(self, truth: StepTruth) -> dict[str, NDArray[np.float64]]:
        """Returns the further entries of the observation.

        Raises:
            TypeError: One is not as many numbers as it has limits.
            ValueError: One of them is nan: an agent would learn nothing from then on.
        """
        return {name: _numbers(sight.of(truth), len(sight.low)) for name, sight in self.sights.items()}


def terms_of(given: object) -> dict[str, float]:
    """Returns the terms of what a reward gave, a number being one.

    Raises:
        TypeError: It is neither.
        ValueError: One is nan or infinite: an agent would learn nothing from then on.
    """
    try:
        terms: Mapping[str, Any] = given if isinstance(given, Mapping) else {OWN: given}
        numbers = {name: float(value) for name, value in terms.items()}
    except (TypeError, ValueError):
        message = f"reward_fn gave {given!r}; it has to return a number, or numbers by name"
        raise TypeError(message) from None
    if not all(map(math.isfinite, numbers.values())):
        raise ValueError(f"reward_fn gave {given!r}; it has to return finite numbers")
    return numbers


def _numbers(given: ArrayLike, count: int) -> NDArray[np.float64]:
    """What a user's observation gave, if it is so many numbers."""
    try:
        numbers = np.asarray(given, np.float64)
    except (TypeError, ValueError):
        numbers = np.empty(0)
    if numbers.shape != (count,):
        raise TypeError(f"observe_fn gave {given!r}; it has to return {count} numbers")
    if np.isnan(numbers).any():
        raise ValueError(f"observe_fn gave {given!r}; it has to return numbers that are not nan")
    return numbers


def own_of(reward: object, terminate: object, observe: object) -> Own:
    """Returns what users bring of their own to an environment.

    Args:
        reward: Function, name of a plug-in or FILE.py:NAME; None for the environment's own.
        terminate: Function (truth) -> bool, name of a plug-in or FILE.py:NAME; None for none.
        observe: A Sight, name of a plug-in or FILE.py:NAME; None for no further entry.

    Raises:
        UsageError: One is not valid.
    """
    name = observe.rpartition(":")[2] if isinstance(observe, str) else OWN
    sights = {} if observe is None else {name: _named("observe_fn", observe, OBSERVATIONS)}
    ends = _named("terminate_fn", terminate, ENDINGS)
    return Own(_named("reward_fn", reward, REWARDS), ends, sights)


def _named(option: str, value: object, table: Table[Any]) -> Any:  # noqa: ANN401 - of the table's kind
    if value is None or table.fits(value):
        return value
    if not isinstance(value, str):
        raise UsageError(f"{option} {value!r} is not valid; give {table.form}, or the name of a plug-in")
    return find_named(option, value, table)
