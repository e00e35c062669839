"""What all environments share: worlds and starts from the seed, actions checked, endings told."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from functools import cached_property
from threading import Lock
from typing import Any, ClassVar, Generic, TypeVar

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.utils import EzPickle
from numpy.typing import NDArray

from harness.base.errors import Diverged, RunFailed, UsageError, unknown
from harness.base.sim_time import CONTROL_PERIOD
from harness.gym.course import Course, draw_variation
from harness.gym.difficulty import Ladder
from harness.gym.observation import Limits, Observation, Part
from harness.gym.options import Options, parse_options
from harness.gym.picture import Painter
from harness.gym.ride import Ride
from harness.samples import Twist
from harness.sensors.depth import DepthOptions
from harness.truth.recorder import TIPPED_OVER
from harness.world.world import Start

RESET_OPTIONS = ("terrain", "difficulty", "world_seed", "start", "goal")
MOST_TRIES = 20  # places at which a start is tried: a few are too steep to stand on
LARGEST_SEED = 2**31
FLIPPED = math.cos(TIPPED_OVER)

Info = dict[str, Any]
Action = NDArray[np.float32]
O = TypeVar("O", bound=Options)  # noqa: E741 - options

_building = Lock()  # MuJoCo's compiler is not promised to work in two threads at once


class RoverEnv(gymnasium.Env[Observation, Action], EzPickle, ABC, Generic[O]):
    """A rover that drives to a goal; one step is a control period of 0.05 s.

    Args:
        render_mode: None, or one of `metadata["render_modes"]`.
        options: Fields of `options_class`, by name.

    Attributes:
        options: As they are understood.
        goal: Where to drive in the world [m].
        parts: Of the observation.

    Raises:
        UsageError: An option does not exist or is not valid.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]  # gymnasium has it for each object
        "render_modes": ["rgb_array", "human"],
        "render_fps": round(1.0 / CONTROL_PERIOD),
    }
    options_class: ClassVar[type[Options]]
    endings: ClassVar[Mapping[str, str]]  # by name: what it is, and whether it terminates or truncates
    actions: tuple[str, str]  # what the two numbers of an action are
    parts: Mapping[str, Part]
    observation_space: spaces.Dict  # type: ignore[assignment]  # gymnasium's are generic
    action_space: spaces.Box  # type: ignore[assignment]

    def __init__(self, render_mode: str | None = None, **options: object) -> None:
        EzPickle.__init__(self, render_mode=render_mode, **options)
        modes = self.metadata["render_modes"]
        if render_mode is not None and render_mode not in modes:
            raise UsageError(
                f"render_mode '{render_mode}' does not exist; available: {', '.join(modes)}"
            )
        name = type(self).__name__
        self.options: O = parse_options(self.options_class, options, name)  # type: ignore[assignment]
        self.render_mode = render_mode
        self._painter: Painter | None = None
        self._ladder = Ladder(self.options.curriculum, self.options.difficulty)
        self._course: Course | None = None
        self._ride: Ride | None = None  # None: there is no episode to step
        self._episodes = 0  # in this world

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        """Begins an episode; a seed begins the first one in the world that `harness.run` has for it.

        Args:
            seed: Of worlds, starts, goals and noise; None goes on with those there are.
            options: Of this episode, any of RESET_OPTIONS: `start` is x, y [m], yaw [rad], `goal` x, y.

        Raises:
            UsageError: An option is not valid, or the rover cannot stand at the start.
        """
        super().reset(seed=seed)
        wanted = _checked_options(options or {})
        rng = self.np_random
        noise_seed = int(rng.integers(LARGEST_SEED)) if seed is None else seed
        if seed is not None:
            self._ladder = Ladder(self.options.curriculum, self.options.difficulty)
        elsewhere = wanted.keys() & {"terrain", "difficulty", "world_seed"}
        used_up = self._episodes >= self.options.episodes_per_world
        if self._course is None or seed is not None or used_up or elsewhere:
            self._course = self._new_course(noise_seed, wanted)
            self._episodes = 0
        self._episodes += 1
        variation = draw_variation(self.options.randomisation, rng)
        ride = self._ride = self._started(self._course, noise_seed, variation, wanted.get("start"))
        x, y, _ = ride.simulation.position
        self.goal = wanted.get("goal") or self._draw_goal((x, y))
        self.steps = 0
        self._shown = ride.simulation.data
        self._begin(ride)
        self._seen = self._observe(ride)
        if self.render_mode == "human":
            self.render()
        run = self._course.run
        return self._fresh_observation(), {
            "terrain": run.world.terrain,
            "world_seed": run.seed,
            "difficulty": run.world.difficulty,
            "start": np.array(ride.simulation.scene.world.start),
            "goal": np.array(self.goal),
            "variation": asdict(variation),
        }

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, Info]:
        """Drives one control period: `accept`, `command`, `drive`, `sense` and `conclude`.

        Raises:
            InvalidAction: It has another shape than the space, or is no number.
            ResetNeeded: There is no episode, or it has ended.
        """
        self.accept(action)
        self.command()
        self.drive()
        self.sense()
        return self.conclude()

    def accept(self, action: Action) -> None:
        """Takes the action of the next step; what follows is to be called in the order of `step`.

        Raises:
            InvalidAction: As `step`; likewise ResetNeeded.
        """
        if self._ride is None:
            raise ResetNeeded("there is no episode to step; call reset() first, and after each episode")
        self._accepted = self._checked_action(action)

    def command(self) -> None:
        """Makes commands of the accepted action."""
        assert self._ride is not None  # noqa: S101 - or nothing was accepted
        self._ride.command(self._twist(self._accepted))

    def drive(self) -> None:
        """Does the physics of the step."""
        assert self._ride is not None  # noqa: S101 - it was commanded
        self._ride.drive()
        self.steps += 1

    def sense(self) -> None:
        """Reads the sensors after the step that was just driven, if it could be driven to its end."""
        assert self._ride is not None  # noqa: S101 - it was driven
        self._failure = ""
        try:
            self._ride.read()
        except Diverged:
            self._failure = "diverged"
        except RunFailed:
            self._failure = "edge"

    def conclude(self) -> tuple[Observation, float, bool, bool, Info]:
        """Returns what `step` returns, of what was just sensed."""
        ride, failure = self._ride, self._failure
        assert ride is not None  # noqa: S101 - it was driven
        if not failure:
            self._seen = self._observe(ride)
        reward, ending, info = self._judge(ride, failure)
        if not ending and self.steps * CONTROL_PERIOD >= self.options.time_limit - 1e-9:
            ending = "time"
        if ending:
            self._ride = None
            self._ladder.take(success=info["is_success"])
        if self.render_mode == "human":
            self.render()
        terminated = ending in self.terminal_endings
        info["ending"] = ending
        return self._fresh_observation(), reward, terminated, bool(ending) and not terminated, info

    def render(self) -> NDArray[np.uint8] | None:
        """Draws the rover from behind with its goal; the image, shape (height, width, 3), or a window.

        Raises:
            ResetNeeded: There has been no episode yet.
            UsageError: OpenGL is missing, or the display.
        """
        if self.render_mode is None:
            gymnasium.logger.warn("render() draws nothing without render_mode='rgb_array' or 'human'")
            return None
        if self._course is None:
            raise ResetNeeded("there is nothing to draw yet; call reset() first")
        if self._painter is None:
            self._painter = Painter(window=self.render_mode == "human")
        return self._painter.draw(self._course, self._shown, self.goal)

    def close(self) -> None:
        """Gives back the window and OpenGL; may be called twice."""
        if self._painter is not None:
            self._painter.close()
            self._painter = None

    @property
    def terminal_endings(self) -> frozenset[str]:
        """Endings by which an episode is terminated; by others it is truncated."""
        return frozenset(name for name, told in self.endings.items() if told.startswith("terminated"))

    @abstractmethod
    def _twist(self, action: list[float]) -> Twist:
        """What an action commands."""

    @abstractmethod
    def _begin(self, ride: Ride) -> None:
        """Called when an episode has begun, before its first observation."""

    @abstractmethod
    def _observe(self, ride: Ride) -> Mapping[str, object]:
        """What is observed now, by the names of the space."""

    @abstractmethod
    def _judge(self, ride: Ride, failure: str) -> tuple[float, str, Info]:
        """The reward of the step that was just driven, how the episode ended ("" if not), the info.

        `failure` is "edge" or "diverged" if the step could not be driven to its end.
        """

    @property
    def _camera(self) -> DepthOptions | None:
        """The depth camera that the rover carries; None for none."""
        return None

    @property
    def _box(self) -> float:
        """Half the side of the square in which starts and goals are [m]."""
        return math.inf

    @property
    def _draws(self) -> np.random.Generator:
        """What starts and goals are drawn from."""
        return self.np_random

    def _draw_goal(self, start: tuple[float, float]) -> tuple[float, float]:
        assert self._course is not None  # noqa: S101 - an episode has one
        return self._course.places.draw(self._draws, start, self.options.goal_distance, self._box)

    def _draw_start(self, course: Course) -> Start:
        if not self.options.random_start:
            return course.scene.world.start
        rng = self._draws
        x, y = course.places.draw(rng, (0.0, 0.0), (0.0, math.inf), self._box)
        return x, y, round(float(rng.uniform(-math.pi, math.pi)), 3)

    def _started(self, course: Course, noise_seed: int, variation: Any, start: Start | None) -> Ride:  # noqa: ANN401
        if start is not None:
            return Ride(course, start, variation, noise_seed)
        for _ in range(MOST_TRIES):
            with suppress(UsageError, RunFailed):
                return Ride(course, self._draw_start(course), variation, noise_seed)
        raise UsageError(
            f"no start was found on {course.run.world.terrain}, seed {course.run.seed}, in {MOST_TRIES} "
            "tries; choose an easier world, or random_start=False"
        )

    def _new_course(self, seed: int, wanted: Mapping[str, Any]) -> Course:
        rng, terrains = self.np_random, self.options.terrain
        terrain = terrains[int(rng.integers(len(terrains)))]
        difficulty = self._ladder.draw(rng)
        run = self.options.episode(
            wanted.get("terrain", terrain),
            wanted.get("world_seed", seed),
            wanted.get("difficulty", difficulty),
        )
        with _building:
            return Course(run, self._camera)

    def _checked_action(self, action: Action) -> list[float]:
        values, limits = np.asarray(action, np.float64), self._action_limits
        if values.shape != (len(limits),):
            raise InvalidAction(f"an action of shape {values.shape} is not valid; give {(len(limits),)}")
        numbers = values.tolist()
        if not all(map(math.isfinite, numbers)):
            raise InvalidAction(f"action {numbers} is not valid; give finite numbers")
        return [min(max(n, low), high) for n, (low, high) in zip(numbers, limits, strict=True)]

    def _fresh_observation(self) -> Observation:
        return self._limits.keep(self._seen)

    @cached_property
    def _limits(self) -> Limits:
        return Limits(self.observation_space)

    @cached_property
    def _action_limits(self) -> list[tuple[float, float]]:
        """Smallest and largest of each number of an action."""
        low, high = self.action_space.low.tolist(), self.action_space.high.tolist()
        return list(zip(low, high, strict=True))


def _checked_options(options: Mapping[str, Any]) -> dict[str, Any]:
    for name in options:
        if name not in RESET_OPTIONS:
            raise UsageError("reset: " + unknown("option", name, RESET_OPTIONS))
    checked = dict(options)
    for name, count in (("start", 3), ("goal", 2)):
        if name in options:
            checked[name] = _numbers(name, options[name], count)
    return checked


def _numbers(name: str, value: Sequence[float], count: int) -> tuple[float, ...]:
    try:
        numbers = tuple(float(item) for item in value)
    except (TypeError, ValueError):
        numbers = ()
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise UsageError(f"reset: {name} {value} is not valid; give {count} finite numbers")
    return numbers
