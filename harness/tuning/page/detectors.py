"""How the detectors of contacts are told apart in figures, and where their thresholds lie on curves."""

from collections.abc import Callable

from harness.page.figure import INK, METRIC, Trace
from harness.tuning.page.traces import OTHER, mark
from harness.tuning.scoring.alarms import DETECTORS
from harness.tuning.scoring.collision import CollisionStudy, DetectorStudy

# Hue says what is measured, the dash whether near returns count.
STYLES = dict(
    zip(DETECTORS, ((METRIC, "solid"), (METRIC, "dash"), (OTHER, "solid"), (OTHER, "dash")), strict=True)
)

Place = Callable[[DetectorStudy], tuple[float, float]]


def operating_points(study: CollisionStudy, place: Place) -> list[Trace]:
    """A mark for the default and for each detector at its tuned value.

    Args:
        study: Of a robot.
        place: Where a detector lies on the figure.
    """
    points = [
        mark("at its best value", *place(told), STYLES[told.name][0], "diamond-open")
        | {"hovertemplate": f"{told.name} below {told.events.value:g} m<extra></extra>"}
        for told in study.detectors
    ]
    default = mark("the default", *place(study.default), INK, "circle")
    return [
        *points,
        default | {"hovertemplate": f"default {study.default.events.value:g} m<extra></extra>"},
    ]
