"""Tables of topics, parameters and terrains for documents."""

import numpy as np

from harness.base.sim_time import HIGHEST_RATE
from harness.robots import ROVERS
from harness.sensors.table import SENSORS, Topic
from harness.world.statistics import residuals, slopes
from harness.world.terrain import DIFFICULTIES
from harness.world.terrains import TERRAINS
from harness.world.world import build_world
from rover_metrics.core.parameter import ParameterInfo
from rover_metrics.extended.settings import PARAMETERS
from rover_metrics.sheet.render import markdown
from rover_metrics.sheet.sheet import Sheet
from rover_metrics.topics import SENSORS as HEARD
from rover_metrics.topics import TRUTH

SEED = 1  # of the terrains that are measured; tools/terrains_picture.py draws it


def topics() -> str:
    """Returns the topics of the sensors that every rover has, in publishing order."""
    rows = []
    for row in (row for row in SENSORS if row.options is None):
        most = "at most " if row.rate == HIGHEST_RATE else ""
        rates = _by_robot({name: f"{most}{row.rate_on(rover)} Hz" for name, rover in ROVERS.items()})
        frames = _by_robot({name: row.frame_on(rover) for name, rover in ROVERS.items()})
        for topic in row.topics:
            cells = (f"`/{topic.name}`", topic.message_type.replace("/msg/", "/"), _qos(topic), rates)
            rows.append((*cells, frames, row.fault or ""))
    text = markdown(Sheet(("topic", "type", "QoS", "rate", "frame", "`--fault`"), tuple(rows)))
    heard, truth = (
        ", ".join(f"`/{source.name.lstrip('/')}`" for source in kind) for kind in (HEARD, TRUTH)
    )
    return f"{text}\n`metrics_node` reads {heard}; with extended columns also {truth}.\n"


def _by_robot(values: dict[str, str]) -> str:
    """One value if all robots have the same, else each with its robot."""
    if len(set(values.values())) == 1:
        return next(iter(values.values()))
    return ", ".join(f"{robot} {value}" for robot, value in values.items())


def _qos(topic: Topic) -> str:
    latched = ", latched" if topic.latched else ""
    return f"{'best effort' if topic.best_effort else 'reliable'}{latched}, {topic.depth}"


def parameters() -> str:
    """Returns all parameters of metrics_node."""
    rows = (
        (f"`{name}`", f"{p.description}. Default: {_default(p)}; valid: {_valid(p)}")
        for name, p in PARAMETERS.items()
    )
    return markdown(Sheet(("parameter", "meaning"), tuple(rows)))


def _default(parameter: ParameterInfo) -> str:
    value = list(parameter.default) if isinstance(parameter.default, tuple) else parameter.default
    text = str(value).lower() if isinstance(value, bool) else str(value)
    return f"`{text}` {parameter.unit}".rstrip()


def _valid(parameter: ParameterInfo) -> str:
    if isinstance(parameter.default, bool):
        return "true, false"
    return parameter.valid or f"{parameter.minimum:g} to {parameter.maximum:g}"


def terrains() -> str:
    """Returns what each terrain measures, from the easiest difficulty to the hardest."""
    slope, rough = ("slope p50 [deg]", "slope p95 [deg]"), ("roughness over 1 m [mm]", "over 0.3 m [mm]")
    titles = ("terrain", *slope, *rough, "obstacles per 100 m²")
    return markdown(Sheet(titles, tuple(map(_measured, TERRAINS))))


def _measured(name: str) -> tuple[str, ...]:
    figures = []
    for difficulty in DIFFICULTIES:
        world = build_world(name, SEED, difficulty)
        p50, p95 = np.percentile(slopes(world.ground), (50, 95))
        rms = [1e3 * np.sqrt(np.mean(residuals(world.ground, w) ** 2)) for w in (1.0, 0.3)]
        density = 100 * len(world.obstacles) / (4 * np.prod(world.ground.half_size))
        figures.append([f"{figure:.1f}" for figure in (p50, p95, *rms, density)])
    columns = zip(*figures, strict=True)
    return (f"[{name}](#{name})", *(", ".join(c if len({*c}) > 1 else c[:1]) for c in columns))


def gallery() -> str:
    """Returns a section for each terrain: what it is, its parameters, its promise, its picture."""
    parts = (
        f"## {name}\n\n{terrain.summary[0].upper()}{terrain.summary[1:]}. Default (easiest..hardest): "
        f"{terrain.describe()}.\nEvery seed at 0.5: {terrain.promise.describe()}.\n\n"
        f"![A Leo Rover on {name}, and {name} from above](terrains/{name}.webp)\n"
        for name, terrain in TERRAINS.items()
    )
    return "\n".join(parts)
