"""The base of all environments: worlds, starts and goals from the seed, steps, endings, rendering."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.utils import EzPickle
from numpy.typing import NDArray

from harness.base.errors import Diverged, RunFailed, find_named
from harness.base.sim_time import CONTROL_PERIOD
from harness.gym.beginning import OF_A_WORLD, drawn_world, reset_options, started
from harness.gym.course import Course, draw_variation
from harness.gym.custom import OWN, StepTruth, own_of, terms_of, truth_of
from harness.gym.driven_rover import DrivenRover
from harness.gym.observation import Limits, Observation, Part, space_of
from harness.gym.options import CurriculumSchedule, Options, parse_options
from harness.gym.picture import Painter
from harness.samples import Twist
from harness.world.world import Start

if TYPE_CHECKING:
    from harness.gym.live import LiveView
    from harness.sensors.depth import DepthOptions

LARGEST_SEED = 2**31
BY_THEMSELVES = ("human", "live")  # render modes that show each step without being asked

Info = dict[str, Any]
Action = NDArray[np.float32]
O = TypeVar("O", bound=Options)  # noqa: E741 - options


def _view(mode: str) -> "Painter | LiveView":
    """What draws in a render mode."""
    if mode != "live":
        return Painter(window=mode == "human")
    from harness.gym.live import LiveView  # noqa: PLC0415 - its extra may be missing

    return LiveView()


class RoverEnv(gymnasium.Env[Observation, Action], EzPickle, ABC, Generic[O]):
    """A rover that drives to a goal; one step is a control period of 0.05 s.

    Args:
        render_mode: None, or one of `metadata["render_modes"]`.
        options: Fields of `options_class`, by name.

    Attributes:
        options: What the environment was made with, parsed.
        course: The world of the current episode; there is none before the first reset.
        driven: The rover of the current episode, or of the last one once that has ended.
        goal: Where to drive, x and y in the world [m].
        parts: Entries of the observation by name.

    Raises:
        UsageError: An option does not exist or is not valid.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]  # gymnasium has it for each object
        "render_modes": ["rgb_array", "human", "live"],
        "render_fps": round(1.0 / CONTROL_PERIOD),
    }
    options_class: ClassVar[type[Options]]
    endings: ClassVar[Mapping[str, str]]  # by name: what it is, and whether it terminates or truncates
    actions: tuple[str, str]  # what the two numbers of an action are
    course: Course
    driven: DrivenRover
    _spec: EnvSpec | None = None
    parts: Mapping[str, Part]
    _own_seen: Mapping[str, object]
    observation_space: spaces.Dict  # type: ignore[assignment]  # gymnasium's are generic
    action_space: spaces.Box  # type: ignore[assignment]

    def __init__(self, render_mode: str | None = None, **options: object) -> None:
        EzPickle.__init__(self, render_mode=render_mode, **options)
        if render_mode is not None:
            find_named("render_mode", render_mode, dict.fromkeys(self.metadata["render_modes"]))
        name = type(self).__name__
        self.options: O = parse_options(self.options_class, options, name)  # type: ignore[assignment]
        self.render_mode = render_mode
        self._camera: DepthOptions | None = None  # that the rover carries
        own = self.options
        self._extra = own_of(own.reward_fn, own.terminate_fn, own.observe_fn)
        self._box = math.inf  # half the side of the square in which starts and goals are [m]
        self._view: Painter | LiveView | None = None
        self._schedule = CurriculumSchedule(self.options.curriculum, self.options.difficulty)
        self._episodes_left = 0  # in this world
        self._is_over = True  # there is no episode to step

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        """Begins an episode; a seed begins the first one in the world that `harness.run` has for it.

        Args:
            seed: Of worlds, starts, goals and noise; None goes on with those there are.
            options: Fields of `ResetOptions`, for this episode.

        Raises:
            UsageError: An option is not valid, or the rover cannot stand at the start.
        """
        super().reset(seed=seed)
        wanted = reset_options(options or {})
        rng = self.np_random
        noise_seed = int(rng.integers(LARGEST_SEED)) if seed is None else seed
        if seed is not None:
            self._schedule = CurriculumSchedule(self.options.curriculum, self.options.difficulty)
        if not self._episodes_left or seed is not None or wanted.keys() & OF_A_WORLD:
            drawn = drawn_world(self.options, self._schedule, rng, noise_seed) | wanted
            run = self.options.episode(*(drawn[name] for name in OF_A_WORLD))
            self._enter(Course(run, self._camera))
        self._episodes_left -= 1
        variation = draw_variation(self.options.randomisation, rng)
        if (goal := wanted.get("goal")) is not None:
            self.course.scene.world.ground.check_place("goal", goal[0], goal[1], margin=0.0)
        if (start := wanted.get("start")) is None:
            self.driven = started(self.course, self._draw_start, variation, noise_seed)
        else:
            self.driven = DrivenRover(self.course, start, variation, noise_seed)
        driven = self.driven
        x, y, _ = driven.simulation.position
        self.goal = goal or self._draw_goal((x, y))
        self.steps = 0
        self._is_over = False
        self._begin(driven)
        self._seen = self._observe(driven)
        self._apart = math.dist(self.goal, (x, y))
        self._own_seen = self._extra.seen(self._truth("")) if self._extra.sights else {}
        if self.render_mode in BY_THEMSELVES:
            self.render()
        run = self.course.run
        return self._limits.keep({**self._seen, **self._own_seen}), {
            "terrain": run.world.terrain,
            "world_seed": run.seed,
            "difficulty": run.world.difficulty,
            "soil": run.world.soil,
            "start": np.array(driven.simulation.scene.world.start),
            "goal": np.array(self.goal),
            "variation": asdict(variation),
        }

    def _enter(self, course: Course) -> None:
        """Has the next episodes in another world; warns of one in which no goal can be far enough."""
        self.course, self._episodes_left = course, self.options.episodes_per_world
        within = np.clip(course.places.middles - course.places.middle, -self._box, self._box)
        far, least = math.hypot(*np.ptp(within, axis=0)), self.options.goal_distance[0]
        if least > far:
            gymnasium.logger.warn(
                f"goal_distance: on {course.run.world.terrain} nothing is {least:g} m away: the "
                f"farthest goals are taken; give less than {far:.0f} m"
            )

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

    def accept(self, action: NDArray[np.floating[Any]]) -> None:
        """Takes the action of the next step or raises as `step`, in whose order the rest is called."""
        if self._is_over:
            raise ResetNeeded("there is no episode to step; call reset() first, and after each episode")
        self._accepted = self._checked_action(action)

    def command(self) -> None:
        """Makes commands of the accepted action."""
        self.driven.command(self._twist(self._accepted))

    def drive(self) -> None:
        """Does the physics of the step."""
        self.driven.drive()
        self.steps += 1

    def sense(self) -> None:
        """Reads the sensors after the step that was just driven, if it could be driven to its end."""
        self._failure = ""
        try:
            self.driven.read()
        except Diverged:
            self._failure = "diverged"
        except RunFailed:
            self._failure = "edge"

    def conclude(self) -> tuple[Observation, float, bool, bool, Info]:
        """Returns what `step` returns, of what was just sensed."""
        driven, failure = self.driven, self._failure
        if not failure:
            self._seen = self._observe(driven)
        goal = self.goal
        reward, ending, info = self._judge(driven, failure)
        if not ending and self.steps * CONTROL_PERIOD >= self.options.time_limit - 1e-9:
            ending = "time"
        if self._extra.needs_truth and failure != "diverged":
            reward, ending = self._own_judgement(reward, ending, info, goal)
        if ending:
            self._is_over = True
            self._schedule.record(success=info["is_success"])
        if self.render_mode in BY_THEMSELVES:
            self.render()
        terminated = ending in self.terminal_endings
        info["ending"] = ending
        seen = self._limits.keep({**self._seen, **self._own_seen})
        return seen, reward, terminated, bool(ending) and not terminated, info

    def _own_judgement(
        self, reward: float, ending: str, info: Info, goal: tuple[float, float]
    ) -> tuple[float, str]:
        """Reward and ending of a step to a goal by the user's own functions, where there are any."""
        if self.goal != goal:  # the next one: what the rover came nearer, it came nearer to the last
            here = self.driven.simulation.position[:2]
            self._apart += math.dist(self.goal, here) - math.dist(goal, here)
        own, truth = self._extra, self._truth(ending)
        self._apart, self._own_seen = truth.distance, own.seen(truth)
        if own.reward is not None:
            info["reward_terms"] = terms_of(own.reward(truth, np.array(self._accepted, np.float32)))
            reward = float(sum(info["reward_terms"].values()))
        if own.terminate is not None and not ending and own.terminate(truth):
            ending = OWN
        return reward, ending

    def _truth(self, ending: str) -> StepTruth:
        return truth_of(self.driven, self.goal, self.steps * CONTROL_PERIOD, self._apart, ending)

    def _space(self, parts: Mapping[str, Part]) -> spaces.Dict:
        """The space of an observation of these parts and of the user's own."""
        return space_of({**parts, **{name: one.part(name) for name, one in self._extra.sights.items()}})

    def render(self) -> NDArray[np.uint8] | None:
        """Draws the rover and its goal: an image, shape (height, width, 3), a window, or a page.

        Raises:
            ResetNeeded: There has been no episode yet.
            UsageError: OpenGL is missing, the display, or viser.
        """
        if self.render_mode is None:
            gymnasium.logger.warn(
                "render() draws nothing without render_mode='rgb_array', 'human' or 'live'"
            )
            return None
        if not hasattr(self, "driven"):
            raise ResetNeeded("there is nothing to draw yet; call reset() first")
        self._view = self._view or _view(self.render_mode)
        return self._view.draw(self.course, self.driven, self.goal, self.steps)

    def close(self) -> None:
        """Gives back the window or page, and OpenGL; may be called twice."""
        if self._view is not None:
            self._view.close()
        self._view = None

    @property
    def spec(self) -> EnvSpec | None:
        """What the environment was made from, with the steps of `time_limit`."""
        return self._spec

    @spec.setter
    def spec(self, value: EnvSpec | None) -> None:
        steps = round(self.options.time_limit / CONTROL_PERIOD)
        self._spec = None if value is None else replace(value, max_episode_steps=steps)

    @property
    def terminal_endings(self) -> frozenset[str]:
        """Endings by which an episode is terminated; by others it is truncated."""
        own = (name for name, meaning in self.endings.items() if meaning.startswith("terminated"))
        return frozenset((*own, OWN))

    @abstractmethod
    def _twist(self, action: list[float]) -> Twist:
        """What an action commands."""

    @abstractmethod
    def _begin(self, driven: DrivenRover) -> None:
        """Called when an episode has begun, before its first observation."""

    @abstractmethod
    def _observe(self, driven: DrivenRover) -> Mapping[str, object]:
        """What is observed now, by the names of the space."""

    @abstractmethod
    def _judge(self, driven: DrivenRover, failure: str) -> tuple[float, str, Info]:
        """Reward, ending ("" for none) and info of a step; failure is "edge", "diverged" or ""."""

    @property
    def _draws(self) -> np.random.Generator:
        """What starts and goals are drawn from."""
        return self.np_random

    def _draw_goal(self, start: tuple[float, float]) -> tuple[float, float]:
        return self.course.places.draw(self._draws, start, self.options.goal_distance, self._box)

    def _draw_start(self) -> Start:
        if not self.options.random_start:
            return self.course.scene.world.start
        rng = self._draws
        x, y = self.course.places.draw(rng, (0.0, 0.0), (0.0, math.inf), self._box)
        return x, y, round(float(rng.uniform(-math.pi, math.pi)), 3)

    def _checked_action(self, action: NDArray[np.floating[Any]]) -> list[float]:
        values, limits = np.asarray(action, np.float64), self._action_limits
        if values.shape != (len(limits),):
            raise InvalidAction(f"an action of shape {values.shape} is not valid; give {(len(limits),)}")
        numbers = values.tolist()
        if not all(map(math.isfinite, numbers)):
            raise InvalidAction(f"action {numbers} is not valid; give finite numbers")
        return [min(max(n, low), high) for n, (low, high) in zip(numbers, limits, strict=True)]

    @cached_property
    def _limits(self) -> Limits:
        return Limits(self.observation_space)

    @cached_property
    def _action_limits(self) -> list[tuple[float, float]]:
        """Smallest and largest of each number of an action."""
        low, high = self.action_space.low.tolist(), self.action_space.high.tolist()
        return list(zip(low, high, strict=True))
