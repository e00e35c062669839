"""RoverHarness/PointNavGoal: PointNav with sparse rewards, as hindsight experience replay wants it.

The rules are those of Gymnasium-Robotics' GoalEnv: `compute_reward` and its siblings judge any pair of
an achieved and a desired goal, one by one or in batches.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.drivers.point_nav import latest
from harness.gym.driven_rover import DrivenRover
from harness.gym.env import Info
from harness.gym.observation import Part
from harness.gym.point_nav import PointNavEnv, PointNavOptions
from harness.samples import Pose
from rover_metrics.core import rotation

FARTHEST = 1000.0  # [m] from the map's middle: maps are smaller, or nobody drives there in an episode
POSITION = "x, y of the rover in the world [m], of /rover/pose_array"
Numbers = NDArray[np.floating[Any]]


class PointNavGoalOptions(PointNavOptions):
    """What PointNavGoal understands: what PointNav does; the weights of `reward` have no effect."""


class PointNavGoalEnv(PointNavEnv):
    """Drives to a goal in the world; the reward is 0 there and -1 anywhere else."""

    options_class = PointNavGoalOptions

    def __init__(self, render_mode: str | None = None, **options: object) -> None:
        super().__init__(render_mode, **options)
        own = {name: part for name, part in self.parts.items() if name != "goal"}
        boxes = [part.space() for part in own.values()]
        low = (*np.concatenate([box.low.ravel() for box in boxes]).tolist(), -1.0, -1.0)
        high = (*np.concatenate([box.high.ravel() for box in boxes]).tolist(), 1.0, 1.0)
        about = f"{', '.join(own)} of PointNav one after the other, then sine and cosine of the yaw"
        self._own = tuple(own)
        self.parts = {
            "observation": Part(low, high, about),
            "achieved_goal": Part((-FARTHEST,) * 2, (FARTHEST,) * 2, POSITION),
            "desired_goal": Part((-FARTHEST,) * 2, (FARTHEST,) * 2, "x, y of the goal in the world [m]"),
        }
        self.observation_space = self._space(self.parts)

    def compute_reward(self, achieved_goal: Numbers, desired_goal: Numbers, info: Any) -> Numbers:  # noqa: ANN401, ARG002
        """Returns 0 where a goal is reached, else -1; for one pair or for many.

        Args:
            achieved_goal: x, y in the world [m], shape (2,) or (n, 2).
            desired_goal: x, y in the world [m], shape (2,) or (n, 2).
            info: Info of the step, which has no effect.
        """
        reached = _apart(achieved_goal, desired_goal) < self.options.goal_radius
        return np.asarray(reached, np.float64) - 1.0

    def compute_terminated(self, achieved_goal: Numbers, desired_goal: Numbers, info: Info) -> bool:
        """Returns whether the episode ends there by itself.

        Args:
            achieved_goal: x, y in the world [m], shape (2,).
            desired_goal: x, y in the world [m], shape (2,).
            info: Info of the step; another ending that terminated it still does.
        """
        ended = info.get("ending", "") in self.terminal_endings - {"reached"}
        return ended or bool(_apart(achieved_goal, desired_goal) < self.options.goal_radius)

    def compute_truncated(self, achieved_goal: Numbers, desired_goal: Numbers, info: Info) -> bool:  # noqa: ARG002
        """Returns whether the step ended the episode without an outcome.

        Args:
            achieved_goal: x, y in the world [m], shape (2,), which has no effect.
            desired_goal: x, y in the world [m], shape (2,), which has no effect.
            info: Info of the step.
        """
        ending = info.get("ending", "")
        return bool(ending) and ending not in self.terminal_endings

    def _observe(self, driven: DrivenRover) -> Mapping[str, object]:
        values = super()._observe(driven)
        pose = latest(driven.readings, Pose)
        yaw = rotation.yaw(pose.orientation)
        flat = [np.asarray(values[name], np.float32) for name in self._own]
        flat.append(np.array([math.sin(yaw), math.cos(yaw)], np.float32))
        achieved, desired = pose.position[:2], self.goal
        return {"observation": np.concatenate(flat), "achieved_goal": achieved, "desired_goal": desired}

    def _to_goal(self, driven: DrivenRover) -> float:
        """Distance to the goal as observed: a reward computed afterwards is the one that was given."""
        achieved = np.array(latest(driven.readings, Pose).position[:2], np.float32)
        return float(_apart(achieved, np.array(self.goal, np.float32)))

    def _judge(self, driven: DrivenRover, failure: str) -> tuple[float, str, Info]:
        _, ending, info = super()._judge(driven, failure)
        del info["reward_terms"]
        return float(ending == "reached") - 1.0, ending, info


def _apart(achieved: Numbers, desired: Numbers) -> Numbers:
    """Distance of each pair of goals [m]."""
    apart = np.asarray(achieved, np.float64) - np.asarray(desired, np.float64)
    return np.asarray(np.hypot(apart[..., 0], apart[..., 1]))
