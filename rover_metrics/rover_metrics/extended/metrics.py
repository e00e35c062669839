"""Extended metrics: the samples that TraversalMetrics has judged in, the cells after the twelve out."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rover_metrics.core.columns import COLUMNS, Cell, Column, Row
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.core.rotation import Quaternion, Vector3
from rover_metrics.errors import ParameterError, unknown
from rover_metrics.extended.energy_columns import EnergyColumns
from rover_metrics.extended.further import FURTHER, Columns
from rover_metrics.extended.imu_columns import ImuColumns
from rover_metrics.extended.scan_columns import ScanColumns
from rover_metrics.extended.settings import ExtendedSettings
from rover_metrics.extended.traffic_columns import IMU, ODOMETRY, POSE, SCAN, TrafficColumns
from rover_metrics.extended.travel_columns import TravelColumns
from rover_metrics.extended.truth_columns import WHEELS, TruthColumns, truth_columns
from rover_metrics.plugins import misfit
from rover_metrics.timing import NANOSECONDS

# What a cell of somebody's columns may be; each goes into a CSV and into JSON.
OF_A_CELL = (int, float, str, np.integer, np.floating, np.bool_, type(None))


def extended_columns(
    wheels: Sequence[str], *, soil: bool = False, energy: bool = False
) -> tuple[Column, ...]:
    """Returns the columns after the twelve.

    Args:
        wheels: Names of the rover's wheels.
        soil: Whether there are those of soil.
        energy: Whether there are those of a battery.
    """
    return (
        *TravelColumns.COLUMNS,
        *ScanColumns.COLUMNS,
        *ImuColumns.COLUMNS,
        *TrafficColumns.COLUMNS,
        *truth_columns(wheels, soil=soil),
        *(EnergyColumns.COLUMNS if energy else ()),
    )


def _further(name: str) -> type[Columns]:
    if name not in FURTHER:
        raise ParameterError(f"columns: {unknown('plug-in', name, FURTHER)} (docs/extend.md)")
    return FURTHER[name]


EXTENDED_COLUMNS = extended_columns(WHEELS)
ALL_COLUMNS = extended_columns(WHEELS, energy=True)
EXTENDED_HEADER: tuple[str, ...] = (*COLUMNS, *(column.header for column in EXTENDED_COLUMNS))


class ExtendedMetrics:
    """The extended columns of one session, beside the `metrics` that have its twelve and its thresholds.

    Each add method takes a sample after `metrics` has, with the stamp of its header [ns] and whether
    `metrics` has used it.

    Attributes:
        truth: Takes what only a simulator knows.
        energy: Takes the states of a battery; None where they are no columns.
        header: Names of a row's columns, the twelve included.
    """

    def __init__(self, metrics: TraversalMetrics, settings: ExtendedSettings) -> None:
        wheels, soil = settings.wheel_names, settings.soil
        self.truth = TruthColumns(wheels, soil=soil)
        self.energy = EnergyColumns() if settings.energy else None
        self._further = [_further(name)(settings) for name in settings.column_names]
        own = extended_columns(wheels, soil=soil, energy=settings.energy)
        columns = (*own, *(column for each in self._further for column in each.COLUMNS))
        self._headers = tuple(column.header for column in columns)
        self.header = (*COLUMNS, *self._headers)
        self._metrics = metrics
        self._travel = TravelColumns()
        self._scans = ScanColumns(settings)
        self._imu = ImuColumns(settings.gravity)
        self._traffic = TrafficColumns()

    def use(self, settings: ExtendedSettings) -> None:
        """Measures by other settings from now on."""
        self._scans.use(settings)
        self._imu.gravity = settings.gravity
        for each in self._further:
            each.settings = settings

    def add_scan(
        self, stamp_ns: int, ranges: ArrayLike, angles: tuple[float, float], *, used: bool
    ) -> None:
        """Takes a scan, as `MetricsSession.take_scan`, and whether the metrics have used it."""
        self._traffic.add(SCAN, stamp_ns, used=True)
        collides = used and self._metrics.clearance < self._metrics.thresholds.collision_threshold
        self._scans.add(stamp_ns, ranges, angles, collides=collides)
        for each in self._further:
            each.add_scan(stamp_ns, ranges, angles)

    def add_imu(
        self, stamp_ns: int, acceleration: Vector3, orientation: Quaternion | None, *, used: bool
    ) -> None:
        """Takes a sample, as `MetricsSession.take_imu`, and whether the metrics have used it."""
        self._traffic.add(IMU, stamp_ns, used=used)
        if used:
            self._imu.add(stamp_ns, acceleration, orientation)
            threshold = self._metrics.thresholds.rough_terrain_threshold
            self._travel.add_imu(stamp_ns, is_rough=math.hypot(*acceleration) > threshold)
            for each in self._further:
                each.add_imu(stamp_ns, acceleration, orientation)

    def add_pose(self, stamp_ns: int, position: Vector3 | None, *, used: bool) -> None:
        """Takes a position, as `MetricsSession.take_pose`, and whether the metrics have used it."""
        self._traffic.add(POSE, stamp_ns, used=used)
        if used and position is not None:
            self._travel.add_pose(stamp_ns, position, self._metrics.thresholds.distance_threshold)
            for each in self._further:
                each.add_pose(stamp_ns, position)

    def add_odometry(self, stamp_ns: int, velocity: Vector3, *, used: bool) -> None:
        """Takes a velocity, as `MetricsSession.take_odometry`, and whether the metrics have used it."""
        self._traffic.add(ODOMETRY, stamp_ns, used=used)
        if used:
            self._travel.add_odometry(stamp_ns, math.hypot(*velocity))
            for each in self._further:
                each.add_odometry(stamp_ns, velocity)

    def row(self, now_ns: int, reported_lost: Mapping[str, int]) -> Row:
        """Returns the row of the session so far, and of what there was since the row before.

        `reported_lost` are the messages that the middleware says it has lost.
        """
        cells = (
            *self._travel.cells(),
            *self._scans.cells(),
            *self._imu.cells(),
            *self._traffic.cells(now_ns, reported_lost),
            *self.truth.cells(),
            *(() if self.energy is None else self.energy.cells(self._metrics.total_distance)),
            *(cell for each in self._further for cell in _cells_of(each)),
        )
        twelve = self._metrics.row(now_ns // NANOSECONDS)
        return replace(twelve, extended=dict(zip(self._headers, cells, strict=True)))


def _cells_of(further: Columns) -> Iterator[Cell]:
    """Yields the cells of somebody's columns as plain values; MisfitError if they are none."""
    given: Any = further.cells()
    cells = tuple(given) if isinstance(given, Iterable) else ()
    if len(cells) != len(further.COLUMNS) or not all(isinstance(cell, OF_A_CELL) for cell in cells):
        raise misfit(
            further, given, f"a number, a text or None for each of {len(further.COLUMNS)} columns"
        )
    for cell in cells:
        plain = cell.item() if isinstance(cell, np.generic) else cell
        yield int(plain) if isinstance(plain, bool) else plain
