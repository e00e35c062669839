"""What a track is: fifty public seeds, each of them a task."""

from abc import ABC, abstractmethod
from pathlib import Path

from harness.base.errors import UsageError
from harness.course.task import Case, Point, Rule, Task
from harness.spec.route import Route, WayPoint
from harness.spec.run import Run

SEEDS = 50  # public ones
NEAR = 0.5  # [m] from a goal that is reached
SLACK = 5.0  # [s] of a run after its time limit, for a clock that starts late


def to(place: Point, radius: float = NEAR) -> Route:
    """Returns the route to a place [m], which is reached within a radius [m]."""
    return Route(points=(WayPoint(at=place, radius=radius),))


class Track(ABC):
    """One kind of task; a subclass says where it takes place.

    Attributes:
        name: On the command line and in receipts.
        summary: What it asks, in a line.
        rule: How it is judged.
        robot: Which rover drives.
    """

    name: str
    summary: str
    rule: Rule = Rule()
    robot: str = "leo"

    def cases(self, seeds: int, folder: Path | None = None) -> list[Case]:
        """Returns the public episodes.

        Args:
            seeds: How many, the first ones.
            folder: Worlds of the user's own instead of those that ship; None for these.

        Raises:
            UsageError: The track has no worlds from files, or the folder has none that can be read.
        """
        if folder is not None:
            raise UsageError(f"--worlds is for track barn; track {self.name} makes its own worlds")
        return [Case(self.name, seed) for seed in range(seeds)]

    def unseen(self, seed: int) -> Case:
        """Returns the episode of a seed that is not public."""
        return Case(self.name, seed)

    @abstractmethod
    def task(self, case: Case, folder: Path) -> Task:
        """Returns what an episode asks; a folder gets the files that its run reads.

        Raises:
            UsageError: Its world cannot be read, or has no way to the goal.
        """

    def run(self, **values: object) -> Run:
        """Returns a run of this track's rover, which obeys commands, with these values of its fields."""
        fields = {"robot": self.robot, "driver": "cmd_vel", "duration": self.rule.limit + SLACK}
        return Run.of(**(fields | values))
