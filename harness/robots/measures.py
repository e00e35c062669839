"""Sizes and places, measured on the compiled model of a rover that does not ship.

Everything is measured in the frame of the root body while all joints are at 0.
"""

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.robots.drivetrain import Drivetrain
from harness.robots.model import COLLIDING_GROUP, extent

MODEST = 0.5  # of the top speed: what the scripted drivers command, at most CRUISE
CRUISE, TURNING = 1.0, 1.0  # [m/s], [rad/s]
EXACTLY_BACKWARD = 1e-6  # [rad]
LOWEST = 0.01  # [m]: less clearance is none


class Measures(Drivetrain):
    """Looks at the model of a rover; raises as Drivetrain does."""

    @property
    def wheel_radius(self) -> float:
        """Radius of the largest wheel [m]."""
        return max(float(self._wheel_size(name)[[0, 2]].max()) / 2 for name in self._wheels)

    @property
    def wheel_width(self) -> float:
        """Width of the widest wheel [m]."""
        return float(max(self._wheel_size(name)[1] for name in self._wheels))

    @property
    def gravity(self) -> float:
        """Gravity of the model, downwards [m/s^2]."""
        return -float(self._model.opt.gravity[2])

    @property
    def lidar_x(self) -> float:
        """Position of the lidar ahead of the root body's origin [m]."""
        return float(self._lidar[0][0])

    @property
    def lidar_y(self) -> float:
        """Position of the lidar to the left of the root body's origin [m]."""
        return float(self._lidar[0][1])

    @property
    def lidar_yaw(self) -> float:
        """Yaw of the lidar in the root body's frame [rad]."""
        axes = self._lidar[1]
        yaw = math.atan2(axes[1, 0], axes[0, 0])
        return math.pi if math.pi - abs(yaw) < EXACTLY_BACKWARD else yaw

    def derived(self) -> dict[str, object]:
        """Returns what rover.yaml may leave out, by its keys."""
        places = np.array([self._place(name) for name in self._wheels])
        left = places[: len(self.drive.left)]
        right = places[len(self.drive.left) :]
        rest_height = self.wheel_radius - float(places[:, 2].min())
        track = float(left[:, 1].mean() - right[:, 1].mean())
        top_speed = self.wheel_speed_limit * self.wheel_radius
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
            "controller_radius": self.wheel_radius,
            "controller_separation": track,
            "footprint": self._footprint(),
            "linear_acceleration": 2.5,
            "angular_acceleration": 3.0,
            "cruise_speed": cruise,
            "cruise_yaw_rate": turning,
            "encoder_ticks": 4096.0,
            "odometry_rate": 50,
            "lidar_height": float(self._lidar[0][2]) + rest_height,
            "clearance": self._clearance(rest_height),
            "step_limit": self.wheel_radius / 2,
        }

    def _wheelbase(self, places: NDArray[np.float64]) -> float:
        ahead = places[:, 0]
        if not self.steered_wheels:
            return float(np.ptp(ahead)) or 2 * self.wheel_radius  # of one axle: what it needs of ground
        steered = np.isin(self._wheels, self.steered_wheels)
        if steered.all():
            raise UsageError(
                f"{self._where}: drive: all wheels are steered; leave those behind as they are"
            )
        return float(ahead[steered].mean() - ahead[~steered].mean())

    def _footprint(self) -> tuple[float, float, float, float]:
        model = self._model
        geoms = np.flatnonzero(model.geom_group == COLLIDING_GROUP).tolist()
        low, high = extent(model, self._data, geoms)
        return float(low[0]), float(high[0]), float(low[1]), float(high[1])

    def _clearance(self, rest_height: float) -> float:
        model = self._model
        wheels = [int(model.joint(name).bodyid[0]) for name in self._wheels]
        colliding = np.flatnonzero(model.geom_group == COLLIDING_GROUP).tolist()
        rest = [geom for geom in colliding if model.body_weldid[model.geom_bodyid[geom]] not in wheels]
        if not rest:
            return self.wheel_radius
        return max(LOWEST, float(extent(model, self._data, rest)[0][2]) + rest_height)

    @cached_property
    def _lidar(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Position [m] and axes of the lidar in the root body's frame, shapes (3,) and (3, 3)."""
        site = self._data.site("lidar")
        return np.array(site.xpos), np.array(site.xmat).reshape(3, 3)

    def _wheel_size(self, joint: str) -> NDArray[np.float64]:
        low, high = extent(self._model, self._data, self._geoms(joint))
        return np.asarray(high - low)


def frame_name(body: str) -> str:
    """Returns what the frame of a body is called: as the body, if that sounds like a frame."""
    return body if body.endswith(("_link", "_frame", "_footprint")) else f"{body}_link"
