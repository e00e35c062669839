"""Traversal metrics of an off-road rover: sensor samples in, one CSV row a second out.

What is named here is for use from elsewhere (docs/api.md), and is loaded when it is asked for.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rover_metrics.core.columns import COLUMNS as COLUMNS
    from rover_metrics.core.columns import Row as Row
    from rover_metrics.core.metrics import TraversalMetrics as TraversalMetrics
    from rover_metrics.core.thresholds import Thresholds as Thresholds
    from rover_metrics.extended.settings import ExtendedSettings as ExtendedSettings
    from rover_metrics.extended.settings import Settings as Settings
    from rover_metrics.log.csv_log import CsvLog as CsvLog
    from rover_metrics.session import MetricsSession as MetricsSession
    from rover_metrics.session import Remark as Remark

_PLACES = {
    "COLUMNS": "rover_metrics.core.columns",
    "CsvLog": "rover_metrics.log.csv_log",
    "ExtendedSettings": "rover_metrics.extended.settings",
    "MetricsSession": "rover_metrics.session",
    "Remark": "rover_metrics.session",
    "Row": "rover_metrics.core.columns",
    "Settings": "rover_metrics.extended.settings",
    "Thresholds": "rover_metrics.core.thresholds",
    "TraversalMetrics": "rover_metrics.core.metrics",
}
__all__ = list(_PLACES)


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(
            f"module 'rover_metrics' has no attribute '{name}'; public: {', '.join(__all__)}"
        )
    return getattr(importlib.import_module(_PLACES[name]), name)
