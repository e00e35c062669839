"""Where the camera stands: near the rover, so that much of its path is seen and nothing hides it."""

import math
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec

Vector = NDArray[np.float64]

DISTANCE = 2.3  # [m] to a rover of USUAL reach, to others in proportion
USUAL, SMALLEST_SCALE = 0.32, 0.4  # [m] the reach of such a rover; least share of the distance
ELEVATION = math.radians(17.0)  # of the camera over the rover
EYE_LEVEL = 0.35  # [m] of the rover that the camera looks at, above its model frame
AHEAD = 0.7  # [m] behind the rover that the picture's middle is aimed at
ASIDE = 0.4  # [m] by which the rover stands beside the middle
AZIMUTHS = np.arange(0.0, 360.0, 7.5)  # [deg] candidates
GROUND_MARGIN = 0.4  # [m] of air below the camera
SOLID_GROUPS = np.array([1, 1, 0, 0, 0, 0], np.uint8)  # terrain and obstacles
CHASE_SIDE, CHASE_ELEVATION = 30.0, -24.0  # [deg]
TOP_ELEVATION, SIDE_ELEVATION = -89.0, -8.0  # [deg]
BEST_FRONT = math.radians(35.0)  # angle between the rover's heading and the camera


@dataclass(frozen=True, eq=False)
class View:
    """A camera as MuJoCo's free camera has it: the target in the world [m], and from where [deg, m]."""

    target: Vector
    azimuth: float
    distance: float
    elevation: float = -math.degrees(ELEVATION)

    @property
    def direction(self) -> Vector:
        """Unit vector of the view."""
        azimuth, elevation = math.radians(self.azimuth), math.radians(self.elevation)
        level = math.cos(elevation)
        return np.array([level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)])

    @property
    def eye(self) -> Vector:
        """Where the camera is [m]."""
        return self.target - self.distance * self.direction

    def camera(self) -> mujoco.MjvCamera:
        """Returns the same view as MuJoCo's own camera."""
        camera = mujoco.MjvCamera()
        camera.lookat[:] = self.target
        camera.azimuth, camera.elevation = self.azimuth, self.elevation
        camera.distance = self.distance
        return camera

    def sees(self, points: Vector, half_width: float) -> NDArray[np.bool_]:
        """Returns which points, shape (n, 3), lie within the picture's width; its tangent is given."""
        right = np.cross(self.direction, (0.0, 0.0, 1.0))
        offsets = points - self.eye
        depth = offsets @ self.direction
        return (depth > 0.5) & (np.abs(offsets @ right) < half_width * depth)


def _view_from(rover: Vector, azimuth: float, aside: float, scale: float) -> View:
    """A view past the rover, which stands `aside` times its scale [m] left of the middle."""
    heading = math.radians(azimuth)
    ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
    right = np.array([ahead[1], -ahead[0], 0.0])
    past = AHEAD * ahead + aside * right + np.array([0.0, 0.0, EYE_LEVEL])
    return View(rover + scale * past, azimuth, scale * (DISTANCE + AHEAD))


def scale_of(rover: RoverSpec) -> float:
    """Returns the size of a rover as a share of the usual one, by which cameras keep off."""
    return max(SMALLEST_SCALE, rover.reach / USUAL)


def chase_view(rover: Vector, yaw: float, scale: float = 1.0, camera: str = "chase") -> View:
    """Returns a view of a rover that moves on with it.

    Args:
        rover: Its place [m].
        yaw: Its heading [rad].
        scale: Of its size to the usual one.
        camera: "chase", "top" or "side": from behind and a little aside, from above, from the left.
    """
    turn, elevation = {
        "chase": (CHASE_SIDE, CHASE_ELEVATION),
        "top": (0.0, TOP_ELEVATION),
        "side": (-90.0, SIDE_ELEVATION),
    }[camera]
    view = replace(_view_from(rover, math.degrees(yaw) + turn, 0.0, scale), elevation=elevation)
    if camera == "chase":
        return view
    return replace(view, target=rover + np.array([0.0, 0.0, 0.5 * EYE_LEVEL * scale]))


def best_view(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    path: Vector,
    yaw: float,
    half_width: float,
    others: Vector | None = None,
    scale: float = 1.0,
) -> View:
    """Returns the best of many views of the rover at the end of its path.

    Args:
        model: The scene.
        data: Its state, with kinematics up to date.
        path: Positions of the rover [m], shape (n, 3), the last is where it is.
        yaw: Its heading [rad].
        half_width: Half the width of the picture at unit distance.
        others: Where other rovers are [m], shape (n, 3); None without any.
        scale: Of the rover's size to the usual one.
    """

    def merit(view: View) -> float:
        shown = float(np.mean(view.sees(path, half_width))) if len(path) > 1 else 0.0
        if others is not None:
            shown += float(np.mean(view.sees(others, half_width)))
        to_camera = math.radians(view.azimuth + 180.0)
        off_front = abs(abs(math.remainder(to_camera - yaw, math.tau)) - BEST_FRONT)
        return shown - 0.25 * off_front - 10.0 * _is_hidden(view, model, data, path[-1])

    views = (
        _view_from(path[-1], azimuth, s * ASIDE, scale) for azimuth in AZIMUTHS.tolist() for s in (-1, 1)
    )
    return max(views, key=merit)


def _is_hidden(view: View, model: mujoco.MjModel, data: mujoco.MjData, rover: Vector) -> bool:
    """Whether ground or an obstacle stands between camera and rover, or the camera is in the ground."""
    hit = np.zeros(1, np.int32)

    def free(direction: Vector) -> float:
        return float(mujoco.mj_ray(model, data, view.eye, direction, SOLID_GROUPS, 1, -1, hit, None))

    if not free(np.array([0.0, 0.0, -1.0])) > GROUND_MARGIN:
        return True
    for height in (0.15, 0.6):
        line = rover + np.array([0.0, 0.0, height]) - view.eye
        distance = float(np.linalg.norm(line))
        if 0.0 <= free(line / distance) < distance - 0.1:
            return True
    return False
