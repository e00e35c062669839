"""RoverHarness/RoboTerrain: the spaces and the reward of RoboTerrain's RoverEnv.

What is a defect there is mended here; each can be had back for comparison with results of then.
"""

import math
import time
from collections import deque
from collections.abc import Mapping
from functools import partial
from typing import Annotated, ClassVar

import numpy as np
from gymnasium import spaces
from pydantic import AfterValidator, field_validator

from harness.base.sim_time import CONTROL_PERIOD, check_duration
from harness.drivers.point_nav import Point, latest, visible, way_to
from harness.gym.driven_rover import DrivenRover
from harness.gym.env import Info, RoverEnv
from harness.gym.observation import Part
from harness.gym.options import Options, Positive
from harness.samples import Imu, LaserScan, Odometry, Pose, Twist
from harness.spec.value import Length, Share, Value, checked
from rover_metrics.core import rotation

SEGMENTS, FARTHEST = 32, 12.0  # of the lidar; [m] that a miss becomes
PROPORTIONAL, DERIVATIVE, FASTEST_TURN = 2.0, 0.1, 7.0  # of the heading controller [1/s], [1], [rad/s]
REACHED, GOAL_REWARD = 0.5, 100.0  # [m]
NEAR, NEAR_REWARD = 0.3, -0.5  # [m] of the lidar at which a collision counts
PROGRESS_SCALE, LEAST_PROGRESS, LEAST_ALIGNMENT, IDLE = 0.3, 0.001, 0.002, -0.03
SCALE, SPEED_SCALE, TURN_SCALE, ALIGNMENT_SCALE = 1.5, 0.0025, 0.0015, 0.01
FLIPPED, FLIPPED_REWARD, SPARED_STEPS = 1.48, -20.0, 500  # [rad]
STUCK_STEPS, STUCK_DISTANCE, STUCK_REWARD = 600, 0.001, -25.0  # [m]
OUTSIDE_REWARD = -10.0

PARTS = {
    "lidar": Part(
        (0.0,), (FARTHEST,), "nearest range of each of 32 sectors of /scan [m]; a miss is 12", SEGMENTS
    ),
    "pose": Part((-30.0, -30.0, -10.0), (30.0, 30.0, 10.0), "x, y, z of /rover/pose_array [m]"),
    "imu": Part((-math.pi,) * 3, (math.pi,) * 3, "pitch, roll, yaw of /imu/data [rad]"),
    "target": Part((0.0, -math.pi), (100.0, math.pi), "distance [m] and bearing [rad] of the goal"),
    "velocities": Part((-10.0,) * 2, (10.0,) * 2, "speed [m/s], yaw rate [rad/s] of /odometry/wheels"),
}


class Defects(Value):
    """What RoboTerrain's RoverEnv does and this environment does not, unless it is asked for.

    Attributes:
        limit_terminates: The time limit is reported as terminated, not as truncated.
        ignores_seed: Starts and goals come from numpy's global generator, whatever the seed.
        wall_clock: The heading controller's derivative is over wall time.
        stale_reward: The reward is that of the observation before the action acted.
        nearest_is_farthest: What is nearer than the lidar sees counts as farthest.
        collisions_uncounted: `collisions` in info stays 0.
    """

    limit_terminates: bool = False
    ignores_seed: bool = False
    wall_clock: bool = False
    stale_reward: bool = False
    nearest_is_farthest: bool = False
    collisions_uncounted: bool = False


class RoboTerrainOptions(Options):
    """What RoboTerrain understands beside what all do; a goal follows on each that is reached.

    Attributes:
        time_limit: Of an episode [s]: 2000 steps.
        goal_distance: From the start or the last goal to the next one [m].
        box: Half the side of the square around the map's middle in which starts and goals are [m].
        reverse_speed: Largest speed backwards [m/s]; 0.6 in RoboTerrain's environment of the Leo Rover.
        defects: Which of the original's are wanted.
    """

    time_limit: Annotated[float, AfterValidator(checked(partial(check_duration, name="time_limit")))] = (
        100.0
    )
    goal_distance: Positive = (0.5, 12.0)
    box: Length = 4.0
    reverse_speed: Share = 1.0
    defects: Defects = Defects()

    @field_validator("lidar_beams", check_fields=False)
    @classmethod
    def _fills_segments(cls, beams: int) -> int:
        if beams % SEGMENTS:
            raise ValueError(f"{beams} lidar_beams are not valid; give a multiple of {SEGMENTS}")
        return beams


class RoboTerrainEnv(RoverEnv[RoboTerrainOptions]):
    """Drives from goal to goal; the action is a speed [m/s] and a change of heading [rad]."""

    options_class = RoboTerrainOptions
    parts = PARTS
    actions = ("speed [m/s]", "heading to take, from the present one, left positive [rad]")
    endings: ClassVar[Mapping[str, str]] = {
        "flipped": "terminated: roll or pitch beyond 1.48 rad; -20, or 0 in the first 500 steps",
        "stuck": "terminated: moved by less than 1 mm in 600 steps; -25",
        "edge": "terminated: half a metre from the edge of the map; -10",
        "diverged": "truncated: the physics blew up; 0",
        "time": "truncated: `time_limit` is over",
    }

    def __init__(self, render_mode: str | None = None, **options: object) -> None:
        super().__init__(render_mode, **options)
        self._defects, self._box = self.options.defects, self.options.box
        self.observation_space = self._space(PARTS)
        slowest = -self.options.reverse_speed
        low, high = np.array([[slowest, -math.pi], [1.0, math.pi]], np.float32)
        self.action_space = spaces.Box(low, high)

    @property
    def terminal_endings(self) -> frozenset[str]:
        """Endings by which an episode is terminated."""
        return super().terminal_endings | ({"time"} if self._defects.limit_terminates else set())

    @property
    def _draws(self) -> np.random.Generator:
        if not self._defects.ignores_seed:
            return self.np_random
        return np.random.default_rng(np.random.randint(2**31))  # noqa: NPY002 - the global one is the defect

    def _begin(self, driven: DrivenRover) -> None:  # noqa: ARG002 - other environments need it
        self._error, self._collisions, self._goals = 0.0, 0, 0
        self._terms: dict[str, float] = {}
        self._distance: float | None = None
        self._places: deque[Point] = deque(maxlen=STUCK_STEPS)
        self._asked_at = time.perf_counter()

    def _twist(self, action: list[float]) -> Twist:
        """RoboTerrain's PD controller of the heading."""
        speed, error = action
        error = math.remainder(error, math.tau)
        change, self._error = error - self._error, error
        rate = PROPORTIONAL * error + DERIVATIVE * change / self._period()
        if self._defects.stale_reward:
            self._early_reward = self._task_reward()
        return Twist(speed, max(-FASTEST_TURN, min(FASTEST_TURN, rate)))

    def _period(self) -> float:
        if not self._defects.wall_clock:
            return CONTROL_PERIOD
        before, self._asked_at = self._asked_at, time.perf_counter()
        return self._asked_at - before

    def _observe(self, driven: DrivenRover) -> Mapping[str, object]:
        readings = driven.readings
        pose, twist = latest(readings, Pose), latest(readings, Odometry).twist
        attitude, scan = latest(readings, Imu).orientation, latest(readings, LaserScan)
        (roll, pitch), yaw = rotation.roll_pitch(attitude), rotation.yaw(attitude)
        ranges = visible(scan.ranges, FARTHEST)
        if self._defects.nearest_is_farthest:
            ranges[np.isneginf(scan.ranges)] = FARTHEST
        self._pose, self._roll, self._pitch, self._twist_now = pose, roll, pitch, twist
        lidar = ranges.reshape(SEGMENTS, -1).min(axis=1)
        self._nearest = float(lidar.min())
        return {
            "lidar": lidar,
            "pose": pose.position,
            "imu": (pitch, roll, yaw),
            "target": way_to(self.goal, pose),
            "velocities": (twist.linear, twist.angular),
        }

    def _judge(self, driven: DrivenRover, failure: str) -> tuple[float, str, Info]:
        if failure == "diverged":
            return 0.0, failure, self._info()
        self._places.append(self._pose.position[:2])
        reward, ending = OUTSIDE_REWARD, failure
        if max(abs(self._roll), abs(self._pitch)) > FLIPPED:
            reward, ending = (FLIPPED_REWARD if self.steps > SPARED_STEPS else 0.0), "flipped"
        elif not failure:
            reward = self._early_reward if self._defects.stale_reward else self._task_reward()
            self._seen = self._observe(driven)  # of the goal that may be a new one
            if self._is_stuck():
                reward, ending = STUCK_REWARD, "stuck"
        return reward, ending, self._info()

    def _info(self) -> Info:
        return {
            "distance": way_to(self.goal, self._pose)[0],
            "collisions": 0 if self._defects.collisions_uncounted else self._collisions,
            "goals": self._goals,
            "is_success": self._goals > 0,
            "reward_terms": dict(self._terms),
        }

    def _is_stuck(self) -> bool:
        is_full = len(self._places) == STUCK_STEPS
        return is_full and math.dist(self._places[0], self._places[-1]) < STUCK_DISTANCE

    def _task_reward(self) -> float:
        """RoboTerrain's reward of what was observed last; chooses a new goal at each that is reached."""
        distance, bearing = way_to(self.goal, self._pose)
        before = self._distance
        self._terms = {}
        if before is None:
            self._distance = distance
            return 0.0
        if distance < REACHED:
            self._goals += 1
            self.goal, self._distance = self._draw_goal(self._pose.position[:2]), None
            self._terms["goal"] = GOAL_REWARD
        elif self._nearest < NEAR:  # the distance before it stays in force
            self._collisions += 1
            self._terms["collision"] = NEAR_REWARD
        else:
            self._distance = distance
            self._terms = self._driving_terms(before - distance, bearing)
        return sum(self._terms.values())

    def _driving_terms(self, progress: float, bearing: float) -> dict[str, float]:
        alignment = ALIGNMENT_SCALE * (1.0 - abs(bearing) / (math.pi / 2))  # 1 ahead, -1 behind
        counts = abs(progress) > LEAST_PROGRESS and alignment > LEAST_ALIGNMENT
        return {
            "distance": SCALE * (PROGRESS_SCALE * progress if counts else IDLE),
            "speed": SPEED_SCALE * self._twist_now.linear,
            "turn": -TURN_SCALE * abs(self._twist_now.angular),
        }
