"""The map: hillshade and obstacles, the path coloured by roughness, collisions, the last scan."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from harness.page import figure as fig
from harness.page.figure import DASHES, INK, Trace, line, numbers
from harness.page.run.encounters import Encounter, encounters
from harness.page.run.hillshade import Hillshade, map_layout
from harness.page.run.log import Event, contacts, meetings
from harness.page.run.recorder import Stretch
from harness.page.run.soil import ruts
from harness.samples import Vector3
from harness.world.actors.actor import Actor
from harness.world.obstacles import Obstacle, ObstacleKind, Points, outline
from harness.world.world import World
from rover_metrics.analysis.social.metrics import PERSONAL_SPACE

SCALE_TOPS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # [m/s^2] few, so that runs can be compared
SATURATED = 99.0  # [%] of the path below the top of the scale
COLORBAR = {
    "orientation": "h",
    "thickness": 10,
    "len": 0.9,
    "y": 1.01,
    "yanchor": "bottom",
    "ypad": 0,
    "outlinewidth": 0,
    "title": {"text": f"roughness ||a| {fig.MINUS} g| [m/s²]", "side": "top"},
}
HOVER = (
    "t = %{customdata[0]:.2f} s<br>roughness %{customdata[1]:.2f} m/s²<br>"
    "x %{x:.2f}, y %{y:.2f}, z %{customdata[2]:.2f} m"
)
PERSON = "--person"
NEAR = f"person within {PERSONAL_SPACE:g} m"
CLOSEST = "closest to a person"
NAMES = {ObstacleKind.ROCK: ("rock", "--rock"), ObstacleKind.HAZARD: ("hazard", "--hazard")}


def roughness(track: Sequence[Stretch], gravity: float) -> list[float]:
    """Returns the largest deviation of |a| from gravity in each stretch [m/s^2], the last known else."""
    latest, values = 0.0, []
    for stretch in track:
        if stretch.highest_acceleration >= 0.0:
            high, low = stretch.highest_acceleration, stretch.lowest_acceleration
            latest = max(high - gravity, gravity - low)
        values.append(latest)
    return values


def map_figure(
    world: World,
    hillshade: Hillshade,
    track: Sequence[Stretch],
    *,
    collisions: Sequence[Event],
    others: Mapping[str, Sequence[Stretch]] = MappingProxyType({}),
    scan: Points,
    gravity: float,
) -> fig.Figure:
    """Returns a run from above, in metres, y up.

    Args:
        world: Where it took place.
        hillshade: Its ground as a picture.
        track: What was recorded.
        collisions: What the metrics counted.
        others: What was recorded of other rovers, by name.
        scan: Where the beams of the last scan ended [m].
        gravity: Of the run [m/s^2].
    """
    touched, near, track = contacts(track), meetings(track), _known(track)
    seen = [stretch.people for stretch in track if stretch.people]
    people = {actor.name: [places[n] for places in seen] for n, actor in enumerate(world.people)}
    rovers = {name: [one.position for one in _known(other)] for name, other in others.items()}
    data = [
        *(_obstacles(world.obstacles, kind) for kind in NAMES),
        _points(scan, "last scan", {"size": 3, "color": fig.SCAN}),
        ruts(track),
        *_ways(people, PERSON),
        *_ways(rovers, INK),
        *_path(track, gravity),
        *_ends(track),
        _encounters(encounters(track), world.people),
        _events(near, NEAR, "circle-open", PERSON),
        _events(collisions, "collision (metric)", "diamond-open", fig.METRIC),
        _events(touched, "contact with a hazard (truth)", "x-thin-open", fig.TRUTH),
    ]
    layout = map_layout(world.ground, hillshade, track)
    return {"data": [trace for trace in data if trace["x"]], "layout": layout}


def _known(track: Sequence[Stretch]) -> list[Stretch]:
    return [stretch for stretch in track if all(map(math.isfinite, stretch.position))]


def _obstacles(obstacles: Sequence[Obstacle], kind: ObstacleKind) -> Trace:
    name, color = NAMES[kind]
    shapes = [outline(obstacle).tolist() for obstacle in obstacles if obstacle.kind is kind]
    # Closed, with a gap between two.
    points = [point for shape in shapes for point in (*shape, shape[0], [math.nan, math.nan])]
    filled = {"fill": "toself", "fillcolor": color}
    return line(name, *_columns(points), "--obstacle-line", width=1) | filled


def _path(track: Sequence[Stretch], gravity: float) -> list[Trace]:
    """A line for contrast with the ground, and on it a point for each stretch, the roughest on top."""
    rough = roughness(track, gravity)
    most = float(np.percentile(rough, SATURATED)) if rough else 0.0
    top = next((top for top in SCALE_TOPS if top >= most), SCALE_TOPS[-1])
    casing = line("path", *_columns([stretch.position[:2] for stretch in track]), "--casing", width=9)
    order = np.argsort(rough, kind="stable").tolist()
    ticks = {"tickvals": [0.0, top / 2, top], "ticktext": ["0", f"{top / 2:g}", f"{top:g} or more"]}
    marker = {
        "size": 6,
        "color": numbers([rough[index] for index in order]),
        "colorscale": "Viridis",
        "cmin": 0.0,
        "cmax": top,
        "colorbar": COLORBAR | ticks,
    }
    details = [
        [round(track[index].time_s, 2), round(rough[index], 3), round(track[index].position[2], 3)]
        for index in order
    ]
    points = _points([track[index].position for index in order], "path", marker, HOVER)
    return [casing | {"showlegend": False}, points | {"showlegend": False, "customdata": details}]


def _ways(places: Mapping[str, Sequence[Vector3]], color: str) -> list[Trace]:
    """Dashed lines by name, and a dot where each ends; none for those without a place."""
    traces: list[Trace] = []
    for number, (name, way) in enumerate(places.items()):
        hover = f"{name}<br>x %{{x:.2f}}, y %{{y:.2f}} m"
        dash = tuple(DASHES)[1 + number % (len(DASHES) - 1)]
        traces.append(line(name, *_columns(way), color, hover=hover, dash=dash))
        end = _points(way[-1:], name, {"size": 9, "color": color}, hover)
        traces.append(end | {"showlegend": False})
    return traces


def _encounters(met: Sequence[Encounter], actors: Sequence[Actor]) -> Trace:
    """Lines from the rover, where the number is that the table has, to whom it met."""
    points, numbered, texts = [], [], []
    for number, one in enumerate(met, 1):
        near, name = one.nearest, actors[one.person].name
        points += [near.rover, near.person, (math.nan, math.nan)]
        numbered += [f"<b>{number}</b>", "", ""]
        texts += [f"{number}: {name}, {near.distance:.2f} m, t = {near.time_s:.1f} s"] * 3
    look = {
        "mode": "lines+markers+text",
        "marker": {"symbol": "diamond", "size": 8, "color": PERSON},
        "text": numbered,
        "textposition": "top right",
        "textfont": {"size": 14, "color": INK},
        "hovertext": texts,
    }
    return line(CLOSEST, *_columns(points), PERSON, hover="%{hovertext}") | look


def _events(events: Sequence[Event], name: str, symbol: str, color: str) -> Trace:
    marker = {"symbol": symbol, "size": 13, "color": color, "line": {"color": color, "width": 3}}
    positions = [event.position for event in events]
    times = [f"{event.start_s:.1f} to {event.end_s:.1f} s" for event in events]
    return _points(positions, name, marker, f"{name}<br>%{{text}}") | {"text": times}


def _ends(track: Sequence[Stretch]) -> list[Trace]:
    if not track:
        return []
    style = {"size": 12, "color": "--panel", "line": {"color": INK, "width": 2}}
    ends = (("start", "circle", track[0]), ("end", "square", track[-1]))
    return [
        _points([end.position], name, {"symbol": symbol, **style}, f"{name}, t = {end.time_s:.2f} s")
        for name, symbol, end in ends
    ]


def _columns(points: Points | Sequence[Sequence[float]]) -> tuple[Sequence[float], Sequence[float]]:
    """The x and the y of places."""
    x, y, *_ = zip(*points, strict=True) if len(points) else ((), ())
    return x, y


def _points(
    points: Points | Sequence[Sequence[float]], name: str, marker: fig.Layout, hover: str | None = None
) -> Trace:
    return fig.points(name, *_columns(points), marker, hover)
