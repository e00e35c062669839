"""Sizes and places, measured on the compiled model of a rover that does not ship.

Everything is measured in the frame of the root body while all joints are at 0.
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.robots.drivetrain import HINGE, STRAIGHT, Drivetrain
from harness.robots.mjcf import EXACTLY_BACKWARD
from harness.robots.model import COLLIDING_GROUP, extent
from harness.robots.spec import RoverSpec

MODEST = 0.5  # of the top speed: what the scripted drivers command, at most CRUISE
CRUISE, TURNING = 1.0, 1.0  # [m/s], [rad/s]
ONE_AXLE = 0.01  # of the wheels' radius: so far apart along x, wheels are of one axle
CARRIES = 0.15  # of the wheels' radius: so near to level ground, a caster touches it
LOWEST = 0.01  # [m]: less clearance is none


class Measures(Drivetrain):
    """Looks at the model of a rover; raises as Drivetrain does."""

    def __init__(self, rover: RoverSpec) -> None:
        super().__init__(rover)
        self._boxes = np.array([self._box(name) for name in self._wheels])
        sizes = np.ptp(self._boxes, axis=1)
        self._radius, self._width = float(sizes[:, [0, 2]].max()) / 2, float(sizes[:, 1].max())
        self._lidar = self._data.site("lidar")
        self._casters = self._carriers()

    def facts(self) -> dict[str, object]:
        """Returns what only the model says, by the fields of RoverSpec."""
        x_x, _, _, y_x, *_ = self._lidar.xmat
        yaw = math.atan2(y_x, x_x)
        return {
            "drive": self.drive,
            "passive_joints": self.passive_joints,
            "steered_wheels": self.steered_wheels,
            "casters": self._casters,
            "wheel_radius": self._radius,
            "wheel_friction": self._friction(),
            "wheel_speed_limit": self.wheel_speed_limit,
            "gravity": -float(self._model.opt.gravity[2]),
            "lidar_x": float(self._lidar.xpos[0]),
            "lidar_y": float(self._lidar.xpos[1]),
            "lidar_z": float(self._lidar.xpos[2]),
            "lidar_yaw": math.pi if math.pi - abs(yaw) < EXACTLY_BACKWARD else yaw,
        }

    def derived(self) -> dict[str, object]:
        """Returns what rover.yaml may leave out, by its keys."""
        places = self._boxes.mean(axis=1)
        left, right = np.split(places, [len(self.drive.left)])
        rest_height = float((np.ptp(self._boxes, axis=1)[:, 2] / 2 - places[:, 2]).max())
        track = float(left[:, 1].mean() - right[:, 1].mean())
        top_speed = self.wheel_speed_limit * self._radius
        cruise = min(MODEST * top_speed, CRUISE)
        mass = float(self._model.body_mass.sum())
        kind = "Ackermann steering" if self.drive.steering else "skid steer"
        wheelbase = self._wheelbase(places)
        turning = min(TURNING, MODEST * top_speed / (track / 2))
        if self.drive.steering:
            turning = cruise / (wheelbase / math.tan(self.drive.steering_limit) + track / 2)
        return {
            "summary": f"{mass:.1f} kg, {len(places)} wheels, {kind}",
            "odometry_child_frame": frame_name(self._model.body(1).name),
            "imu_frame": "imu_link",
            "rest_height": rest_height,
            "wheelbase": wheelbase,
            "track": track,
            "controller_radius": self._radius,
            "controller_separation": track,
            "footprint": self._footprint(),
            "wheel_width": self._width,
            "linear_acceleration": 2.5,
            "angular_acceleration": 3.0,
            "cruise_speed": cruise,
            "cruise_yaw_rate": turning,
            "encoder_ticks": 4096.0,
            "odometry_rate": 50,
            "lidar_height": float(self._lidar.xpos[2]) + rest_height,
            "clearance": self._clearance(rest_height),
            "step_limit": self._radius / 2,
        }

    def _friction(self) -> float:
        """The friction of the wheels on ground of 1; MuJoCo takes the larger unless one has priority."""
        model, wheels = self._model, [self._body_of(name) for name in self._wheels]
        tyres = np.flatnonzero(np.isin(model.geom_bodyid, wheels) & (model.geom_contype > 0))
        own, wins = model.geom_friction[tyres, 0], model.geom_priority[tyres] > 0
        return float(np.where(wins, own, np.maximum(own, 1.0)).max(initial=0.0)) or 1.0

    def _wheelbase(self, places: NDArray[np.float64]) -> float:
        ahead = places[:, 0]
        if not self.steered_wheels:
            span = float(np.ptp(ahead))
            of_one_axle = span <= ONE_AXLE * self._radius
            return 2 * self._radius if of_one_axle else span  # what it needs of ground
        steered = np.isin(self._wheels, self.steered_wheels)
        if steered.all():
            raise UsageError(
                f"{self._where}: drive: all wheels are steered; leave those behind as they are"
            )
        return float(ahead[steered].mean() - ahead[~steered].mean())

    def _footprint(self) -> tuple[float, ...]:
        low, high = extent(self._model, self._data, self._colliding())
        return float(low[0]), float(high[0]), float(low[1]), float(high[1])

    def _colliding(self) -> list[int]:
        return np.flatnonzero(self._model.geom_group == COLLIDING_GROUP).tolist()

    def _carriers(self) -> tuple[str, ...]:
        """Bodies on the ground beside the wheels: those that roll freely, of one axle's rover all."""
        model, bodies = self._model, dict[int, list[int]]()
        for geom in self._no_wheels():
            bodies.setdefault(int(model.geom_bodyid[geom]), []).append(geom)
        lowest, highest = self._boxes[:, 0, 2].min(), self._boxes[:, 1, 2].max()
        is_one_axle = np.ptp(self._boxes.mean(axis=1)[:, 0]) < self._radius
        names = []
        for body, geoms in bodies.items():
            below, above = extent(model, self._data, geoms)
            is_low = max(below[2] - lowest, above[2] - highest) <= CARRIES * self._radius
            if is_low and (is_one_axle or self._rolls_freely(int(model.body_weldid[body]))):
                names.append(model.body(body).name)
        return tuple(names)

    def _rolls_freely(self, body: int) -> bool:
        model, joint = self._model, int(self._model.body_jntadr[body])
        is_hinge = joint > 0 and model.jnt_type[joint] == HINGE and not model.jnt_limited[joint]
        return bool(is_hinge and abs(self._data.xaxis[joint][1]) > STRAIGHT)

    def _no_wheels(self) -> list[int]:
        """What collides and is on no wheel."""
        wheels = [self._body_of(name) for name in self._wheels]
        bodies = self._model.body_weldid[self._model.geom_bodyid]
        return [geom for geom in self._colliding() if bodies[geom] not in wheels]

    def _clearance(self, rest_height: float) -> float:
        model = self._model
        carriers = [model.body(name).id for name in self._casters]
        rest = [geom for geom in self._no_wheels() if model.geom_bodyid[geom] not in carriers]
        if not rest:
            return self._radius
        return max(LOWEST, float(extent(model, self._data, rest)[0][2]) + rest_height)


def frame_name(body: str) -> str:
    """Returns what the frame of a body is called: as the body, if that sounds like a frame."""
    return body if body.endswith(("_link", "_frame", "_footprint")) else f"{body}_link"
