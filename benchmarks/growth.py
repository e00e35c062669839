"""What a scan costs as the map grows, its cells shrink and the beams become more."""

from collections.abc import Callable

from benchmarks.measuring import Effort, Rounds, Table, timed
from benchmarks.scenes import poses, scene_on_hills
from harness.robots.lidar import LidarSpec
from harness.sensors.lidar import Lidar

BASE = {"map size": 40.0, "cell": 0.1, "beams": 360.0}
SERIES = {  # the second is the base
    "map size": (20.0, 40.0, 80.0),
    "cell": (0.2, 0.1, 0.05),
    "beams": (180.0, 360.0, 720.0),
}
UNITS = {"map size": " m", "cell": " m", "beams": ""}
OBSTACLES = 100
SCANS_PER_POSE = 20


def measure(effort: Effort) -> Table:
    """One row per series: half, base and double."""
    rows = []
    for name, values in SERIES.items():
        contestants = {f"{v:g}": _scans(BASE | {name: v}, effort.poses) for v in values}
        rounds = Rounds(contestants, effort.rounds)
        base = f"{values[1]:g}"
        ratios = (f"{v:g}{UNITS[name]}: **{rounds.ratio(f'{v:g}', base):.2f}**" for v in values)
        scan = rounds.median(base) / (effort.poses * SCANS_PER_POSE)
        rows.append((name, *ratios, f"{1e6 * scan:.0f} us"))
    return Table(
        title=f"Growth of a scan's cost against its base: {_in_words(BASE)}",
        columns=("what changes", "less or coarser", "base", "more or finer", "base scan"),
        rows=tuple(rows),
    )


def _in_words(shape: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:g}{UNITS[name]}" for name, value in shape.items())


def _scans(shape: dict[str, float], places: int) -> Callable[[], float]:
    scene = scene_on_hills(shape["map size"], shape["cell"], OBSTACLES)
    states = poses(scene, places)
    lidar = Lidar(scene.model, LidarSpec(beams=round(shape["beams"])))

    def scan() -> None:
        for data in states:
            for _ in range(SCANS_PER_POSE):
                lidar.scan(data)

    scan()
    return timed(scan)
