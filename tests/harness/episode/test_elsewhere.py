"""A world that does not lie about the origin is driven, seen and walked in as one that does."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.base.message_types import typestore
from harness.course.planner import Planner
from harness.episode.assembly import check_world, fleet, graded_world, world_of
from harness.episode.episode import episodes_of
from harness.episode.maps import MAP, occupancy_bytes
from harness.episode.together import Together
from harness.gym.places import Places
from harness.page.run.hillshade import map_layout, shade
from harness.samples import ActorPoses, GroundTruth, LaserScan, Sample, TruthState
from harness.sensors.height_scan import HeightScan
from harness.spec import Run
from harness.spec.fleet import parse_rovers
from harness.view.ground import drawn
from harness.world.heightfield import finer
from harness.world.occupancy import occupancy
from tests.support.rovers import LEO

POSTS = ((3.013, 0.517), (-4.009, 2.011), (1.511, -4.013), (7.007, 3.011))  # no edge is a cell's
AWAY = (64.0, -32.0)  # sums with it are as good as exact


def solid(name: str, x: float, y: float, z: float, size: str, lean: float = 0.0) -> str:
    shape = f"<collision name='c'><geometry><box><size>{size}</size></box></geometry></collision>"
    link = f"<pose>{x} {y} {z} {lean} {lean} 0</pose><link name='l'>{shape}</link>"
    return f"<model name='{name}'><static>1</static>{link}</model>"


def written(path: Path, x: float, y: float) -> Path:
    posts = (solid(f"p{n}", x + a, y + b, 0.5, ".3 .4 1") for n, (a, b) in enumerate(POSTS))
    floor = solid("floor", x, y, -0.5, "20 14 1", 0.03)
    path.write_text(f"<sdf version='1.9'><world name='w'>{floor}{''.join(posts)}</world></sdf>")
    return path


def told(sample: Sample, away: tuple[float, float]) -> list[Any]:
    """What a sample tells, its places from somewhere else in the world."""
    match sample:
        case GroundTruth():
            return [sample.x - away[0], sample.y - away[1], sample.yaw]
        case HeightScan():
            heights = np.nan_to_num(sample.heights)
            return [sample.x - away[0], sample.y - away[1], sample.z, *heights.flat]
        case ActorPoses():
            return [*(np.array(sample.position) - [*away, 0.0]).flat]
        case LaserScan():
            return [*np.nan_to_num(sample.ranges, posinf=99.0)]
        case TruthState():
            ruts = () if sample.soil is None else sample.soil.ruts
            return [*sample.traversal, *(np.array(ruts).reshape(-1, 3) - [*away, 0.0]).flat]
        case _:
            return []


def test_a_world_that_lies_elsewhere_is_the_same(tmp_path: Path) -> None:
    common: dict[str, Any] = {"duration": 1.0, "seed": 3, "sensors": "height_scan", "soil": "firm"}
    common |= {"actors": ["a=social:within=3", "b=social:within=3"], "targets": ["post:within=4"]}
    found = []
    for x, y in ((0.0, 0.0), AWAY):
        file, start = written(tmp_path / f"{x}.sdf", x, y), (x + 0.313, y - 0.207, 0.3)
        run = Run.of(terrain=str(file), start=start, **common)
        run = fleet(run, parse_rovers(["leo:a,driver=ram", "rover_zero4wd:b,driver=roam"], run.rover))
        check_world(run)
        episodes, world = episodes_of(run), world_of(run)
        for each in episodes:
            assert (each.info.notes, each.info.files) == (world.notes, world.files)
            assert each.info.targets == {"post": world.targets[0].position}
        ticks = [tick for period in Together(episodes).batches() for one in period for tick in one.ticks]
        found.append([number for t in ticks for each in t.samples for number in told(each, (x, y))])
        found[-1] += np.nan_to_num(graded_world(run).layers["danger"]).ravel().tolist()
    assert found[1] == pytest.approx(found[0], abs=1e-3)


def test_maps_and_ways_of_a_world_that_lies_elsewhere_are_the_same(tmp_path: Path) -> None:
    found = []
    for x, y in ((0.0, 0.0), AWAY):
        world = world_of(Run.of(terrain=str(written(tmp_path / f"{x}.sdf", x, y))))
        ground, message = world.ground, occupancy_bytes(occupancy(world, 0.3, 0.1), 0)
        grid: Any = typestore().deserialize_cdr(message, MAP.message_type)
        corner = grid.info.origin.position
        bumps = replace(ground, heights=np.random.default_rng(1).normal(size=ground.heights.shape))
        ways = np.nan_to_num(Planner(world, LEO).lengths((x + 0.313, y - 0.207)), posinf=99.0)
        track: list[Any] = [SimpleNamespace(position=(x + 8.0, y - 5.0, 0.0))]
        seen: Any = map_layout(ground, shade(ground), track)
        ranges = np.transpose([seen["xaxis"]["range"], seen["yaxis"]["range"]])
        places = (corner.x, corner.y), ranges, Places(world, LEO).middles, drawn(bumps).middle
        found.append([*ways.flat, *(n for each in places for n in np.subtract(each, (x, y)).flat)])
        found[-1] += np.subtract(finer(ground, 2).middle, (x, y)).tolist()
    assert found[1] == pytest.approx(found[0], abs=1e-3)
