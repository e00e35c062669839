"""Traversal metrics of an off-road rover: sensor samples in, one CSV row a second out.

What is named here is for use from elsewhere (docs/api.md), and is loaded when it is asked for.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rover_metrics.core.columns import COLUMNS, Row
    from rover_metrics.core.metrics import TraversalMetrics
    from rover_metrics.core.thresholds import Thresholds
    from rover_metrics.extended.settings import ExtendedSettings, Settings
    from rover_metrics.log.csv_log import CsvLog
    from rover_metrics.session import MetricsSession, Remark

__all__ = [
    "COLUMNS",
    "CsvLog",
    "ExtendedSettings",
    "MetricsSession",
    "Remark",
    "Row",
    "Settings",
    "Thresholds",
    "TraversalMetrics",
]
_PLACES = {
    "core.columns": ("COLUMNS", "Row"),
    "core.metrics": ("TraversalMetrics",),
    "core.thresholds": ("Thresholds",),
    "extended.settings": ("ExtendedSettings", "Settings"),
    "log.csv_log": ("CsvLog",),
    "session": ("MetricsSession", "Remark"),
}


def __getattr__(name: str) -> object:
    for place, names in _PLACES.items():
        if name in names:
            return getattr(importlib.import_module(f"rover_metrics.{place}"), name)
    raise AttributeError(
        f"module 'rover_metrics' has no attribute '{name}'; public: {', '.join(__all__)}"
    )
