"""Lenses: where a camera sees a direction, and the views that its image is put together from.

The optical frame is REP-103's: x to the right, y down, z ahead. Pixels are counted from the middle of
the upper left one, as OpenCV and sensor_msgs/CameraInfo have them.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]


@dataclass(frozen=True)
class Lens(ABC):
    """Base of the lenses; their pixels are square, the optical axis goes through the image's middle."""

    distortion_model: ClassVar[str]
    coefficients: ClassVar[int]  # of distortion, all of which are 0
    widest: ClassVar[float]  # [rad]

    width: int  # [pixels]
    height: int  # [pixels]
    fov: float  # horizontally, from the outer edge of the first column to that of the last [rad]

    @property
    @abstractmethod
    def focal(self) -> float:
        """Returns the focal length [pixels]."""

    @property
    def centre(self) -> tuple[float, float]:
        """Returns where the optical axis meets the image: column and row [pixels]."""
        return 0.5 * (self.width - 1), 0.5 * (self.height - 1)

    @property
    def matrix(self) -> Doubles:
        """Returns the intrinsic matrix K, shape (3, 3) [pixels]."""
        column, row = self.centre
        return np.array([[self.focal, 0.0, column], [0.0, self.focal, row], [0.0, 0.0, 1.0]])

    def offsets(self) -> tuple[Doubles, Doubles]:
        """Returns x and y of every pixel off the optical axis over the focal length, (height, width)."""
        rows, columns = np.indices((self.height, self.width))
        column, row = self.centre
        x, y = (columns - column) / self.focal, (rows - row) / self.focal
        return np.asarray(x, np.float64), np.asarray(y, np.float64)


@dataclass(frozen=True)
class Pinhole(Lens):
    """Straight lines stay straight: r = f tan(theta)."""

    distortion_model = "plumb_bob"
    coefficients = 5
    widest = math.radians(170.0)

    @property
    def focal(self) -> float:
        """Returns the focal length [pixels]."""
        return 0.5 * self.width / math.tan(0.5 * self.fov)


@dataclass(frozen=True)
class Equidistant(Lens):
    """A fisheye whose angles are evenly spaced: r = f theta. What would be behind it is black."""

    distortion_model = "equidistant"
    coefficients = 4
    widest = math.tau

    @property
    def focal(self) -> float:
        """Returns the focal length [pixels]."""
        return self.width / self.fov

    def directions(self) -> Doubles:
        """Returns every pixel's unit direction in the optical frame, (height, width, 3).

        NaN beyond 180 degrees.
        """
        x, y = self.offsets()
        theta = np.hypot(x, y)
        aside = np.sinc(theta / math.pi)  # sin(theta) / theta
        seen = np.where(theta <= math.pi, 1.0, np.nan)
        return np.stack([seen * aside * x, seen * aside * y, seen * np.cos(theta)], axis=-1)


LENSES: dict[str, type[Lens]] = {"pinhole": Pinhole, "fisheye": Equidistant}
