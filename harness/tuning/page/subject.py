"""One robot of the page, its study beside its episodes; and what the figures of all robots share."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from harness.page.figure import (
    COLUMN,
    INK,
    METRIC,
    MUTED,
    PANEL,
    Figure,
    Layout,
    Plot,
    Trace,
    common_layout,
    level,
    line,
    numbers,
)
from harness.tuning.episodes.plan import Part, Planned
from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.scoring.choose import Records
from harness.tuning.scoring.result import Verdict
from harness.tuning.scoring.study import RobotStudy, scored_records

SHARE = {"range": [-0.02, 1.02]}  # of an axis from 0 to 1


@dataclass(frozen=True, eq=False)
class Subject:
    """A robot with everything known of it.

    Attributes:
        records: Its episodes by part, in the order of the plan, without those that diverged.
    """

    study: RobotStudy
    records: Records

    @property
    def test(self) -> Sequence[EpisodeRecord]:
        """Episodes on which no threshold was chosen."""
        return self.records[Part.TEST]

    def plot(self, name: str, what: str, figure: Figure) -> Plot:
        """Returns a figure of this robot.

        Args:
            name: Tells it from the robot's others.
            what: It shows, as text.
            figure: For Plotly.
        """
        return Plot(f"{self.study.robot}-{name}", f"{self.study.robot}: {what}", figure)


def subject(study: RobotStudy, records: Mapping[Planned, EpisodeRecord]) -> Subject:
    """Returns a study beside its episodes among those of a sweep."""
    return Subject(study, scored_records(study.robot, records))


def curve(
    name: str, x: Iterable[float], y: Iterable[float], color: str = METRIC, **style: object
) -> Trace:
    """Returns a curve that tells its values under the pointer.

    Args:
        name: In the legend.
        x: Of its points.
        y: Likewise.
        color: Name of a custom property of the style sheet.
        style: Of the line, in Plotly's terms.
    """
    return line(name, [*x], [*y], color, hover=f"{name}<br>%{{x}}: %{{y:.3f}}", **style)


def chance(name: str, share: tuple[float, float] = (0.0, 1.0)) -> Trace:
    """Returns what guessing gives, at both ends of the x axis."""
    return curve(name, (0.0, 1.0), share, MUTED, dash="dot", width=1)


def mark(name: str, x: float, y: float, *, tuned: str = "", hover: str = "") -> Trace:
    """Returns a point: of a default, or an open one of a tuned value.

    Args:
        name: In the legend.
        x: Where.
        y: Where.
        tuned: Colour of a tuned value; empty for a default.
        hover: Text under the pointer; the name and the place if empty.
    """
    color = tuned or INK
    return {
        "type": "scatter",
        "mode": "markers",
        "cliponaxis": False,
        "name": name,
        "x": numbers([x], 4),
        "y": numbers([y], 4),
        "marker": {
            "symbol": "diamond-open" if tuned else "circle",
            "size": 11,
            "color": tuned or PANEL,
            "line": {"color": color, "width": 2.5},
        },
        "hovertemplate": f"{hover or f'{name}<br>%{{x:.3g}}: %{{y:.3f}}'}<extra></extra>",
    }


def levels(verdict: Verdict) -> list[Layout]:
    """Returns lines where the default and the tuned value of a threshold lie."""
    default, unit = verdict.default.value, spelled(verdict.unit)
    lines = [level(f"default {default:g} {unit}", column(default), "dot")]
    if verdict.tuned is not None:
        value = verdict.tuned.value
        lines.append(level(f"{chosen(verdict)} {value:g} {unit}", column(value), "dash"))
    return lines


def column(x: float) -> Layout:
    """Returns a place on the x axis, from bottom to top of the plot."""
    return {"x0": x, "x1": x, **COLUMN}


def figure(data: Sequence[Trace], x: Layout, y: Layout, shapes: Sequence[Layout] = ()) -> Figure:
    """Returns a figure.

    Args:
        data: Its traces.
        x: Its axes, as `y`.
        y: Likewise.
        shapes: Levels on it.
    """
    layout = common_layout(xaxis=x, yaxis=y, shapes=list(shapes), hovermode="closest")
    return {"data": list(data), "layout": layout}


def chosen(verdict: Verdict) -> str:
    """Returns what to call the chosen value: the parameter file has it only if it is proven."""
    return "chosen (not proven)" if verdict.value is None else "tuned"


def spelled(unit: str) -> str:
    """Returns a unit with a true exponent."""
    return unit.replace("^2", "²")
