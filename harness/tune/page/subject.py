"""One robot of the page, its study beside its episodes; and what the figures of all robots share."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from harness.page import figure as fig
from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring.choose import Records, Verdict
from harness.tune.scoring.study import RobotStudy
from rover_metrics.sheet.sheet import spelled

SHARE = {"range": [-0.02, 1.02]}  # of an axis from 0 to 1


@dataclass(frozen=True, eq=False)
class Subject:
    """A robot's study and its scored records."""

    study: RobotStudy
    records: Records

    @property
    def test(self) -> Sequence[EpisodeRecord]:
        """Episodes on which no threshold was chosen."""
        return self.records[Part.TEST]

    def plot(
        self,
        name: str,
        summary: str,
        data: Sequence[fig.Trace],
        x: fig.Layout,
        y: fig.Layout,
        shapes: Sequence[fig.Layout] = (),
    ) -> fig.Plot:
        """Returns a figure of this robot.

        Args:
            name: On the page, behind the robot's.
            summary: Says in words what it shows.
            data: Its traces.
            x: The axis.
            y: The axis.
            shapes: Lines across the plot.
        """
        layout = fig.common_layout(xaxis=x, yaxis=y, shapes=list(shapes), hovermode="closest")
        figure = {"data": list(data), "layout": layout}
        return fig.Plot(f"{self.study.name}-{name}", f"{self.study.name}: {summary}", figure)


def curve(
    name: str, x: Iterable[float], y: Iterable[float], color: str = fig.METRIC, **style: object
) -> fig.Trace:
    """Returns a curve that shows its values under the pointer.

    Args:
        name: In the legend.
        x: Shape (n,).
        y: Shape (n,).
        color: Name of a custom property of the style sheet.
        style: Of the line, in Plotly's terms: dash, width [px], shape.
    """
    return fig.line(name, [*x], [*y], color, hover=f"{name}<br>%{{x}}: %{{y:.3f}}", **style)


def chance(name: str, share: tuple[float, float] = (0.0, 1.0)) -> fig.Trace:
    """Returns what guessing gives, at both ends of the x axis."""
    return curve(name, (0.0, 1.0), share, fig.MUTED, dash="dot", width=1)


def mark(name: str, x: float, y: float, *, tuned: str = "", hover: str = "") -> fig.Trace:
    """Returns a point.

    Args:
        name: In the legend.
        x: In the unit of its axis.
        y: In the unit of its axis.
        tuned: Colour of an open point, for a tuned value; "" for a default's.
        hover: Template of the text under the pointer; "" for name, x and y.
    """
    return {
        "type": "scatter",
        "mode": "markers",
        "cliponaxis": False,
        "name": name,
        "x": fig.numbers([x], 4),
        "y": fig.numbers([y], 4),
        "marker": {
            "symbol": "diamond-open" if tuned else "circle",
            "size": 11,
            "color": tuned or fig.PANEL,
            "line": {"color": tuned or fig.INK, "width": 2.5},
        },
        "hovertemplate": f"{hover or f'{name}<br>%{{x:.3g}}: %{{y:.3f}}'}<extra></extra>",
    }


def levels(verdict: Verdict) -> list[fig.Layout]:
    """Returns lines where the default and the tuned value of a threshold lie."""
    default, unit = verdict.default.value, spelled(verdict.unit)
    lines = [upright(f"default {default:g} {unit}", default, "dot")]
    if verdict.tuned is not None:
        value = verdict.tuned.value
        lines.append(upright(f"{chosen(verdict)} {value:g} {unit}", value, "dash"))
    return lines


def upright(name: str, x: float, dash: str, color: str = fig.INK) -> fig.Layout:
    """Returns a line from bottom to top of a plot, as one of its shapes.

    Args:
        name: In the legend.
        x: Where it is, in the unit of the axis.
        dash: One of `figure.DASHES`.
        color: Name of a custom property of the style sheet.
    """
    return fig.level(name, {"x0": x, "x1": x, **fig.COLUMN}, dash, color)


def chosen(verdict: Verdict) -> str:
    """Returns what to call the chosen value: the parameter file has it only if it is proven."""
    return "chosen (not proven)" if verdict.value is None else "tuned"
