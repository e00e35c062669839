"""What a column of the log is: the one source of headers and of the data dictionary."""

from dataclasses import dataclass

YES = "yes"  # to: is it the same whatever the rate of its sensor?

Cell = int | float | None  # None is an empty cell: there is nothing to say


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column.

    Attributes:
        name: Its name without the unit.
        unit: Its unit; empty for a count, a flag, a ratio or text.
        meaning: What it is.
        formula: How it is computed, and over which window.
        source: Topics and fields.
        rate_invariant: YES, or how the sensor's rate shows in it.
    """

    name: str
    unit: str = ""
    meaning: str
    formula: str
    source: str
    rate_invariant: str = YES

    @property
    def header(self) -> str:
        """How it is called in the log."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name
