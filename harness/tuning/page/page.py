"""The page of a tuning."""

from collections.abc import Mapping, Sequence

from harness.page.shell import fill
from harness.tuning.episodes.plan import Planned
from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.page.content import content
from harness.tuning.scoring.study import RobotStudy


def render(studies: Sequence[RobotStudy], records: Mapping[Planned, EpisodeRecord], command: str) -> str:
    """The HTML of a tuning's report; the same arguments give the same bytes.

    Args:
        studies: One per robot, in the order of the page.
        records: All episodes that they were made from.
        command: What makes this page.
    """
    return fill("tuning", content(studies, records, command), package="harness.tuning.page")
