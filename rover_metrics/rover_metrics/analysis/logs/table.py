"""The usable rows of a file as typed columns, and a tally of what was not usable."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.logs.log import Floats, Integers


@dataclass
class Tally:
    """How often something was met, and where first."""

    count: int = 0
    first: int = 0
    example: str = ""

    def add(self, lines: Integers, example: str = "") -> None:
        """Count some lines, ascending."""
        if lines.size and not self.count:
            self.first, self.example = int(lines[0]), example
        self.count += int(lines.size)


@dataclass
class Table:
    """The usable rows of a file, and a tally of what was not usable.

    Attributes:
        lines: Line of the file that each row stands on, from 1.
        stamps: Time of each row [s], finite.
        columns: The columns asked for; NaN where the file has no finite number.
        total: Rows of the file.
        long: Rows with more fields than the header.
        short: Rows cut short, or with fewer fields than the header for another reason.
        untimed: Other rows without a finite time.
        cells: Cells without a number, by column.
        infinite: Cells that are infinite, by column.
        spaces: Whether cells of the first row begin with a space.
    """

    lines: Integers = field(default_factory=lambda: np.empty(0, np.int64))
    stamps: Floats = field(default_factory=lambda: np.empty(0))
    columns: dict[str, NDArray[np.floating]] = field(default_factory=dict)
    total: int = 0
    long: Tally = field(default_factory=Tally)
    short: Tally = field(default_factory=Tally)
    untimed: Tally = field(default_factory=Tally)
    cells: dict[str, Tally] = field(default_factory=dict)
    infinite: dict[str, Tally] = field(default_factory=dict)
    spaces: bool = False

    def keep(self, rows: NDArray[np.bool_]) -> None:
        """Keep only some of the rows."""
        if not rows.all():
            self.lines, self.stamps = self.lines[rows], self.stamps[rows]
            self.columns = {name: column[rows] for name, column in self.columns.items()}
