"""One robot of the page: its study beside the episodes that it was made from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.page.figure import Figure, Plot
from harness.tuning.episodes.plan import Part, Planned
from harness.tuning.episodes.record import Ending, EpisodeRecord
from harness.tuning.scoring.choose import Records
from harness.tuning.scoring.study import RobotStudy


@dataclass(frozen=True, eq=False)
class Subject:
    """A robot with everything known of it.

    Attributes:
        records: Its episodes by part, in the order of the plan, without those that diverged.
    """

    study: RobotStudy
    records: Records

    @property
    def robot(self) -> str:
        """Its name."""
        return self.study.robot

    @property
    def checking(self) -> Sequence[EpisodeRecord]:
        """Episodes on which no threshold was chosen."""
        return self.records[Part.CHECKING]

    def plot(self, name: str, what: str, figure: Figure) -> Plot:
        """A figure of this robot; the row that it stands in has its heading and caption."""
        return Plot(f"{self.robot}-{name}", self.robot, "", f"{self.robot}: {what}", figure)


def subject(study: RobotStudy, records: Mapping[Planned, EpisodeRecord]) -> Subject:
    """Finds the episodes of a study among those of a sweep."""
    ordered = sorted(records.items(), key=lambda item: item[0].index)
    mine = {
        part: [
            record
            for planned, record in ordered
            if planned.part is part
            and planned.config.robot == study.robot
            and record.ending is not Ending.DIVERGED
        ]
        for part in Part
    }
    return Subject(study, mine)
