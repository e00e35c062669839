"""Columns of the lidar: events instead of scans, near returns, clearance of the footprint."""

import math

import numpy as np
from numpy.typing import ArrayLike

from rover_metrics.core.columns import Cell, Column
from rover_metrics.extended.footprint import Footprint, FootprintClearance
from rover_metrics.extended.settings import ExtendedSettings
from rover_metrics.timing import EVENT_GAP_NS

_FOOTPRINT = "footprint, lidar_pose; LaserScan ranges, angle_min, angle_increment"

Beams = tuple[float, float, int]  # first azimuth, step [rad], how many


class ScanColumns:
    """The lidar's account, with the settings of the footprint."""

    COLUMNS = (
        Column(
            name="Collision Events",
            meaning="Collisions so far, a lasting one counted once.",
            formula="Scans that Total Collisions counts; a new event begins after "
            f"{EVENT_GAP_NS / 1e9:g} s or more without one, by the scans' stamps.",
            source="/scan",
            cumulative=True,
        ),
        Column(
            name="Near Return Scans",
            meaning="Scans so far with something nearer than range_min, which no other column sees.",
            formula="Scans with at least one range of -inf (REP-117).",
            source="/scan",
            rate_invariant="no: it counts scans",
            cumulative=True,
        ),
        Column(
            name="Footprint Clearance",
            unit="m",
            meaning="Distance from the nearest lidar return to the rover's outline; inf without one.",
            formula="Minimum since the row before over scans and finite ranges of the distance to the "
            "polygon, 0 inside; with near_returns_as_contact, -inf is 0.",
            source=_FOOTPRINT,
            rate_invariant="nearly: more scans see a shorter minimum",
        ),
        Column(
            name="Footprint Collisions",
            meaning="Scans so far whose footprint clearance was below footprint_threshold.",
            formula="Count; strictly below.",
            source=_FOOTPRINT,
            rate_invariant="no: it counts scans",
            cumulative=True,
        ),
    )

    def __init__(self, settings: ExtendedSettings) -> None:
        # None until there was something to count.
        self._events: int | None = None
        self._collision_ns: int | None = None  # stamp of the latest collision
        self._near_returns: int | None = None
        self._collisions: int | None = None
        self._nearest: float | None = None
        self.use(settings)

    def use(self, settings: ExtendedSettings) -> None:
        """Measures by other settings from now on."""
        self._settings = settings
        self._lidar: tuple[Beams, FootprintClearance] | None = None

    def add(
        self, stamp_ns: int, ranges: ArrayLike, angles: tuple[float, float], *, collides: bool
    ) -> None:
        """Takes a scan, as `MetricsSession.take_scan`, and whether it counts as a collision."""
        values = np.asarray(ranges, dtype=np.float32)
        if stamp_ns:  # without one nothing tells whether a collision lasts
            self._events = self._events or 0
            if collides:
                last, self._collision_ns = self._collision_ns, stamp_ns
                # A clock that is set back parts events too.
                self._events += last is None or abs(stamp_ns - last) >= EVENT_GAP_NS
        self._near_returns = (self._near_returns or 0) + bool(np.isneginf(values).any())
        footprint = self._settings.footprint
        if footprint is not None:
            beams = (*angles, values.size)
            distance = self._tables(footprint, beams).nearest(values)
            self._nearest = distance if self._nearest is None else min(self._nearest, distance)
            near = distance < self._settings.footprint_threshold
            self._collisions = (self._collisions or 0) + near

    def cells(self) -> tuple[Cell, ...]:
        """Returns the cells of a row; the minimum begins anew."""
        nearest, self._nearest = self._nearest, None
        return self._events, self._near_returns, nearest, self._collisions

    def _tables(self, footprint: Footprint, beams: Beams) -> FootprintClearance:
        if self._lidar is None or beams != self._lidar[0]:  # lidars rarely change their beams
            settings, (angle_min, angle_increment, count) = self._settings, beams
            fan = angle_min + angle_increment * np.arange(count)
            clearance = FootprintClearance(
                footprint,
                settings.lidar_pose,
                fan if math.isfinite(angle_min + angle_increment) else np.zeros(count),
                near_returns_are_contacts=settings.near_returns_as_contact,
            )
            self._lidar = (beams, clearance)
        return self._lidar[1]
