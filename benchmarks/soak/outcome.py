"""What a scenario of the soak came to, and what must be true of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from benchmarks.resident import MEGABYTE

HOUR = 3600.0  # [s]
GROWTH = 5 * MEGABYTE  # per simulated hour, and in any shorter time
COLUMNS = (
    "scenario",
    "simulated",
    "times real time",
    "messages",
    "lost",
    "rows",
    "bytes as without ROS",
    "memory from the first minute to the end",
)


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """One scenario."""

    scenario: str  # what was done
    seconds: int  # simulated time that was planned [s]
    failure: str | None  # what the run itself says went wrong; None if it came to its end
    speed: float  # simulated seconds per wall second
    messages: int  # how many were published
    lost: int  # how many of those a metrics node did not handle, of the worst node and over all topics
    rows: tuple[int, ...]  # rows in the log of each metrics node
    same: bool  # whether each log has the bytes of the run without ROS
    # memory [bytes] from the first minute to the end, by process; empty if not watched
    grown: Mapping[str, float] = field(default_factory=dict)

    @property
    def complaints(self) -> tuple[str, ...]:
        """What should not be so; empty if all is well."""
        may_grow = GROWTH * max(self.seconds / HOUR, 1.0)
        found = [self.failure] if self.failure else []
        found += [f"{self.lost} messages lost"] if self.lost else []
        if set(self.rows) != {self.seconds}:
            found.append(f"rows: {', '.join(map(str, self.rows))} instead of {self.seconds}")
        if not self.same:
            found.append("a log differs from that of the run without ROS")
        for process, grown in self.grown.items():
            found += [f"{process} grew by {_megabytes(grown)}"] if grown > may_grow else []
        return tuple(f"{self.scenario}: {complaint}" for complaint in found)

    def cells(self) -> tuple[str, ...]:
        """The row of the table."""
        rows = f"{self.rows[0]:,}" if len(self.rows) == 1 else f"{len(self.rows)} x {self.rows[0]:,}"
        grown = ", ".join(f"{process} **{_megabytes(size)}**" for process, size in self.grown.items())
        return (
            self.scenario,
            f"{self.seconds:,} s",
            f"{self.speed:.1f}",
            f"{self.messages:,}",
            f"**{self.lost}**",
            rows,
            "yes" if self.same else "**no**",
            grown or "-",
        )


def _megabytes(size: float) -> str:
    return f"{size / MEGABYTE:+.2f} MB"
