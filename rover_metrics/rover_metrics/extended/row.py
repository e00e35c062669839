"""A row with extended columns after the twelve."""

from dataclasses import dataclass

from rover_metrics.core.column import Cell, Column
from rover_metrics.core.row import COLUMNS, DECIMALS, Field, MetricsRow
from rover_metrics.extended.imu_columns import ImuColumns
from rover_metrics.extended.scan_columns import ScanColumns
from rover_metrics.extended.traffic_columns import TrafficColumns
from rover_metrics.extended.travel_columns import TravelColumns
from rover_metrics.extended.truth_columns import TruthColumns

EXTENDED_COLUMNS: tuple[Column, ...] = (
    *TravelColumns.COLUMNS,
    *ScanColumns.COLUMNS,
    *ImuColumns.COLUMNS,
    *TrafficColumns.COLUMNS,
    *TruthColumns.COLUMNS,
)
EXTENDED_HEADER: tuple[str, ...] = (*COLUMNS, *(column.header for column in EXTENDED_COLUMNS))


@dataclass(frozen=True)
class ExtendedRow:
    """The metrics at one second.

    Attributes:
        base: The twelve columns.
        cells: The values of EXTENDED_COLUMNS.
    """

    base: MetricsRow
    cells: tuple[Cell, ...]

    @property
    def stamp_s(self) -> int:
        """ROS time [s]."""
        return self.base.stamp_s

    @property
    def columns(self) -> tuple[str, ...]:
        """The header that fits the row."""
        return EXTENDED_HEADER

    def as_fields(self) -> tuple[Field, ...]:
        """Give the CSV cells, floats rounded to four decimals; an empty one is empty text."""
        return (*self.base.as_fields(), *map(_field, self.cells))


def _field(cell: Cell) -> Field:
    if cell is None:
        return ""
    return round(cell, DECIMALS) if isinstance(cell, float) else cell
