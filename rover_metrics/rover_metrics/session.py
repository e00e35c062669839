"""Makes the rows of a session: of the twelve columns, or of these and the extended ones."""

from collections.abc import Mapping

from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.core.row import COLUMNS, Row
from rover_metrics.extended.metrics import NANOSECONDS, NONE_LOST, ExtendedMetrics
from rover_metrics.extended.row import EXTENDED_HEADER
from rover_metrics.extended.settings import ExtendedSettings
from rover_metrics.extended.traffic_columns import Topic


class RowSource:
    """One session's metrics and what its rows are made of.

    Args:
        metrics: The twelve columns.
        settings: Of the extended ones; None without them.

    Attributes:
        metrics: As given.
        extended: The metrics of the extended columns; None without them.
    """

    def __init__(self, metrics: TraversalMetrics, settings: ExtendedSettings | None = None) -> None:
        self.metrics = metrics
        self.extended = None if settings is None else ExtendedMetrics(metrics, settings)

    @property
    def columns(self) -> tuple[str, ...]:
        """The header of the rows."""
        return COLUMNS if self.extended is None else EXTENDED_HEADER

    def row(self, now_ns: int, reported_lost: Mapping[Topic, int] = NONE_LOST) -> Row:
        """Sum up the session so far.

        Args:
            now_ns: ROS time of the row [ns].
            reported_lost: Messages that the middleware says it has lost, by topic.
        """
        if self.extended is None:
            return self.metrics.row(now_ns // NANOSECONDS)
        return self.extended.row(now_ns, reported_lost)
