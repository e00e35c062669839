"""RoverHarness/PointNav: to a point, by lidar, IMU and wheel odometry, without touching hazards."""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, Self

import numpy as np
from gymnasium import spaces
from pydantic import BeforeValidator, model_validator

from harness.base.sim_time import CONTROL_PERIOD
from harness.drivers.point_nav import GOAL_RADIUS, commanded, latest, observed, visible
from harness.gym.driven_rover import DrivenRover
from harness.gym.env import Info, RoverEnv
from harness.gym.observation import (
    Part,
    depth_part,
    height_part,
    heights_around,
    point_nav_parts,
    soil_part,
)
from harness.gym.options import Options
from harness.physics.truth.recorder import TIPPED_OVER
from harness.robots import REAL, find_rover
from harness.robots.lidar import LidarSpec
from harness.samples import Pose, Twist
from harness.sensors.depth import DepthOptions
from harness.sensors.ranging import RangeReading
from harness.spec.value import Finite, Length, Value, as_tuple, checked, made
from rover_metrics.core import rotation

ENERGY = "energy"  # the only term that is left out where it is not weighed


class PointNavWeights(Value):
    """Weights of the reward's terms.

    Attributes:
        progress: Metres that the rover came nearer to the goal.
        reached: 1 at the goal.
        time: 1 in each step.
        hazard: Seconds of contact with hazards.
        scrape: Seconds in which anything but a wheel touched the ground.
        flipped: 1 if the rover lies on its side or roof.
        action_rate: Change of the action, both components' magnitudes added.
        sinkage: Depth of the deepest wheel in soil [m], in each step.
        stuck: 1 in each step in which wheels turn in soil without getting on.
        energy: Taken by the motors [W h]; needs actuators="real".
    """

    progress: Finite = 1.0
    reached: Finite = 10.0
    time: Finite = -0.01
    hazard: Finite = -10.0
    scrape: Finite = -1.0
    flipped: Finite = -10.0
    action_rate: Finite = -0.01
    sinkage: Finite = 0.0
    stuck: Finite = 0.0
    energy: Finite = 0.0


class PointNavOptions(Options):
    """What PointNav understands beside what all do.

    Attributes:
        goal_radius: Distance at which the goal counts as reached [m].
        hazard_budget: Contact with hazards that ends an episode [s].
        height_scan: Whether the ground around the rover is observed too, as `heights`.
        depth: Width and height of a depth camera's image [pixels], which is observed too, as `depth`.
        soil_state: Whether sinkage, slip angle and forces of each wheel in soil are observed, as `soil`.
        images: Whether `depth` and `heights` are images, (height, width, 1) and (ahead, left, 1), for
            convolutions; else flat.
        reward: Weights of the reward's terms.
    """

    goal_radius: Length = GOAL_RADIUS
    hazard_budget: Length = 1.0
    height_scan: bool = False
    images: bool = False
    depth: Annotated[tuple[int, ...], BeforeValidator(as_tuple)] = ()
    soil_state: bool = False
    reward: PointNavWeights = PointNavWeights()

    @property
    def camera(self) -> DepthOptions | None:
        """The depth camera that is observed; None for none."""
        if not self.depth:
            return None
        (width, height), rate = self.depth, round(1.0 / CONTROL_PERIOD)
        return made(DepthOptions, {"name": "depth", "width": width, "height": height, "rate": rate})

    @model_validator(mode="after")
    def _knows_its_energy(self) -> Self:
        if self.reward.energy and self.actuators != REAL:
            raise ValueError("the reward's weight 'energy' needs actuators 'real'; give both or neither")
        return self

    @model_validator(mode="after")
    def _has_a_camera(self) -> Self:
        if len(self.depth) not in (0, 2):
            raise ValueError(f"depth {list(self.depth)} is not valid; give width and height in pixels")
        checked(lambda _: self.camera)(None)
        of_soil = {"soil_state": self.soil_state, "the reward's weight 'sinkage'": self.reward.sinkage}
        of_soil |= {"the reward's weight 'stuck'": self.reward.stuck}
        for name, wanted in of_soil.items():
            if wanted and not all(self.soil):
                raise ValueError(f"{name} is of soil; give soil in all worlds, or leave it out")
        return self


class PointNavEnv(RoverEnv[PointNavOptions]):
    """Drives to a goal whose direction is observed; the action is speed and yaw rate."""

    options_class = PointNavOptions
    endings: ClassVar[Mapping[str, str]] = {
        "reached": "terminated: within `goal_radius` of the goal",
        "flipped": "terminated: tilted by more than 75 deg",
        "hazard": "terminated: `hazard_budget` of contact with hazards is spent",
        "edge": "truncated: half a metre from the edge of the map",
        "diverged": "truncated: the physics blew up",
        "time": "truncated: `time_limit` is over",
    }

    def __init__(self, render_mode: str | None = None, **options: object) -> None:
        super().__init__(render_mode, **options)
        lidar = LidarSpec(beams=self.options.lidar_beams)
        self._range_max = lidar.range_max
        self.parts: Mapping[str, Part] = point_nav_parts(lidar.beams, lidar.range_max)
        if self.options.height_scan:
            self.parts = {**self.parts, "heights": height_part(image=self.options.images)}
        if (camera := self.options.camera) is not None:
            self._camera = camera
            self.parts = {**self.parts, "depth": depth_part(camera, image=self.options.images)}
        rover = self._rover = find_rover(self.options.robot)
        if self.options.soil_state:
            self.parts = {**self.parts, "soil": soil_part(len(rover.wheel_joints))}
        self.observation_space = self._space(self.parts)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self.actions = (
            f"speed; 1 is {rover.top_speed:.3g} m/s, as fast as the wheels of {rover.name} turn",
            f"yaw rate; 1 is {rover.cruise_yaw_rate:.3g} rad/s to the left for {rover.name}",
        )
        weights = dict(self.options.reward)
        self._weights = {n: weight for n, weight in weights.items() if weight or n != ENERGY}

    def _begin(self, driven: DrivenRover) -> None:
        self._distance = self._to_goal(driven)
        self._hazard_s = self._action_rate = 0.0
        self._action: list[float] = [0.0, 0.0]

    def _twist(self, action: list[float]) -> Twist:
        before, self._action = self._action, action
        self._action_rate = sum(abs(now - then) for now, then in zip(self._action, before, strict=True))
        return commanded(action, self._rover)

    def _observe(self, driven: DrivenRover) -> Mapping[str, object]:
        values = observed(driven.readings, self.goal, self._range_max)
        if self.options.height_scan:
            ground, pose = driven.simulation.ground, latest(driven.readings, Pose)
            values["heights"] = heights_around(ground, pose)
        if (camera := self._camera) is not None:
            ranges = latest(driven.readings, RangeReading).ranges
            values["depth"] = visible(ranges, camera.range_max)
        if self.options.soil_state and driven.soil is not None:
            values["soil"] = driven.soil.values[:-1]
        return values

    def _judge(self, driven: DrivenRover, failure: str) -> tuple[float, str, Info]:
        before, distance = self._distance, self._to_goal(driven)
        diverged = failure == "diverged"
        self._distance = before if diverged else distance
        hazard_s, scrape_s = (0.0, 0.0) if failure else (driven.hazard_s, driven.scrape_s)
        self._hazard_s += hazard_s
        ending = failure
        if not diverged:
            ending = self._ending(driven) or failure
        measured = {
            "progress": before - self._distance,
            "reached": float(ending == "reached"),
            "time": 1.0,
            "hazard": hazard_s,
            "scrape": scrape_s,
            "flipped": float(ending == "flipped"),
            "action_rate": self._action_rate,
            "sinkage": 0.0 if driven.soil is None else max(driven.soil.sinkage),
            "stuck": 0.0 if driven.soil is None else float(driven.soil.stuck),
            ENERGY: driven.energy,
        }
        terms = {name: weight * measured[name] for name, weight in self._weights.items()}
        x, y, _ = driven.simulation.position
        info = {
            "x_position": x,
            "y_position": y,
            "distance": self._distance,
            "hazard_s": self._hazard_s,
            "is_success": ending == "reached",
            "reward_terms": terms,
        }
        return sum(terms.values()), ending, info

    def _ending(self, driven: DrivenRover) -> str:
        if rotation.tilt(driven.simulation.orientation) > TIPPED_OVER:
            return "flipped"
        if self._hazard_s >= self.options.hazard_budget - 1e-9:  # a sum of hundredths
            return "hazard"
        return "reached" if self._distance < self.options.goal_radius else ""

    def _to_goal(self, driven: DrivenRover) -> float:
        x, y, _ = driven.simulation.position
        return math.dist(self.goal, (x, y))
