"""Columns of energy, where there are messages of a battery; after all others, by parameter `energy`."""

from rover_metrics.core.columns import Cell, Column
from rover_metrics.timing import NANOSECONDS

HOUR, KILOMETRE = 3600.0, 1000.0  # [s], [m]
SHORTEST = 1.0  # [m]: a shorter way says nothing of energy per way
LONGEST_PAUSE = 5.0  # [s] between two messages over which power is taken to change evenly

_SOURCE = "/battery/battery_state voltage, current"


class EnergyColumns:
    """What has been taken from the battery, and how far it went."""

    COLUMNS = (
        Column(
            name="Energy",
            unit="Wh",
            meaning="Taken from the battery so far; charging gives back.",
            formula="Sum of -voltage x current over time, as a trapezoid between two messages; none "
            f"over pauses of more than {LONGEST_PAUSE:g} s.",
            source=_SOURCE,
            cumulative=True,
        ),
        Column(
            name="Energy per Kilometre",
            unit="Wh/km",
            meaning=f"Taken so far over the way so far; empty below {SHORTEST:g} m.",
            formula="Energy / Distance Traveled.",
            source=f"{_SOURCE}; /rover/pose_array position",
        ),
    )

    def __init__(self) -> None:
        self._last: tuple[int, float] | None = None  # stamp [ns], power [W]
        self._energy: float | None = None

    def add(self, stamp_ns: int, voltage: float, current: float) -> None:
        """Takes a state of the battery.

        Args:
            stamp_ns: Stamp of the header [ns].
            voltage: Of the battery [V].
            current: Negative while it discharges [A].
        """
        power = -voltage * current
        if self._last is not None and stamp_ns:
            elapsed = (stamp_ns - self._last[0]) / NANOSECONDS
            counts = 0.0 < elapsed <= LONGEST_PAUSE
            gained = (power + self._last[1]) / 2 * elapsed / HOUR if counts else 0.0
            self._energy = (self._energy or 0.0) + gained
        self._last = stamp_ns, power

    def cells(self, distance: float) -> tuple[Cell, ...]:
        """Returns the cells of a row, after a way [m]."""
        if self._energy is None:
            return None, None
        return self._energy, self._energy * KILOMETRE / distance if distance >= SHORTEST else None
