"""Columns of others, after the extended ones: what they must be, and their table."""

from typing import ClassVar

from numpy.typing import ArrayLike

from rover_metrics.core.columns import Cell, Column
from rover_metrics.core.rotation import Quaternion, Vector3
from rover_metrics.extended.settings import ExtendedSettings
from rover_metrics.plugins import Table


class Columns:
    """Base of somebody's columns: takes the samples that the metrics use, gives the cells of a row.

    A class of columns takes what it needs and leaves the other methods as they are. Stamps are those of
    the headers [ns].

    Attributes:
        COLUMNS: What they are called and mean, in their order.
        settings: Those that hold now: others, once a parameter of the node has been changed.

    Args:
        settings: Of the extended columns: footprint, gravity, wheels.
    """

    COLUMNS: ClassVar[tuple[Column, ...]] = ()

    def __init__(self, settings: ExtendedSettings) -> None:
        self.settings = settings

    def add_scan(self, stamp_ns: int, ranges: ArrayLike, angles: tuple[float, float]) -> None:
        """Takes a scan.

        Args:
            stamp_ns: Stamp of the header [ns].
            ranges: Distances [m], coded as REP-117 says.
            angles: Azimuth of the first beam and step to the next, in the lidar's frame [rad].
        """

    def add_imu(self, stamp_ns: int, acceleration: Vector3, orientation: Quaternion | None) -> None:
        """Takes a sample of the IMU.

        Args:
            stamp_ns: Stamp of the header [ns].
            acceleration: In the IMU's frame, gravity included [m/s^2].
            orientation: Attitude of the IMU as (x, y, z, w); None if it gives none.
        """

    def add_pose(self, stamp_ns: int, position: Vector3) -> None:
        """Takes a true position in the world [m]."""

    def add_odometry(self, stamp_ns: int, velocity: Vector3) -> None:
        """Takes the linear velocity by the wheels, in the base frame [m/s]."""

    def cells(self) -> tuple[Cell, ...]:
        """Returns the cells of a row, one per column; None is an empty one."""
        raise NotImplementedError


def _are_named(columns: type[Columns]) -> bool:
    names = [column.name for column in columns.COLUMNS]
    return all(name.strip() and name.isprintable() for name in names) and len({*names}) == len(names)


FURTHER = Table[type[Columns]](
    "columns",
    {},
    lambda value: isinstance(value, type) and issubclass(value, Columns) and _are_named(value),
    "a subclass of rover_metrics.extended.further.Columns whose COLUMNS have a name each, in a line",
)
