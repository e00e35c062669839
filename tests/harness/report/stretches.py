"""A track of the report, made by hand."""

from typing import Any

from harness.report.recorder import Stretch


def stretches(*changes: dict[str, Any]) -> list[Stretch]:
    """A drive along x at 1 m/s, a stretch a second."""
    return [
        Stretch(float(i + 1), (float(i + 1), 0.0, 0.0), float(i + 1), **values)
        for i, values in enumerate(changes)
    ]
