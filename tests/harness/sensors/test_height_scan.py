"""The height scan against MuJoCo's own rays from above, and where its cells are."""

import math
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.episode.episode import Episode
from harness.physics.scene import build_scene
from harness.physics.simulation import Simulation
from harness.sensors.height_scan import HeightScan, HeightScanOptions, HeightScanSensor
from harness.spec.run import Run
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World
from tests.harness.conftest import MakeSimulation
from tests.harness.sensors.installed import installation
from tests.harness.sensors.mujoco_rays import meets
from tests.support.rovers import LEO

SIZE = (1.6, 0.9)


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    """A rover among rocks, put beside one."""
    episode = Episode(Run.of(terrain="rocky", duration=0.05, seed=2))
    simulation = episode.simulation
    rock = next(o for o in simulation.scene.world.obstacles if o.kind is ObstacleKind.ROCK)
    simulation.put(rock.position[0] - 0.7, rock.position[1] + 0.2, 0.1)
    return simulation


def scan(
    simulation: Any,  # noqa: ANN401 - or what stands for a Simulation
    xyz: tuple[float, float, float] = (0, 0, 0),
    turn: NDArray[np.float64] | None = None,
    **told: object,
) -> HeightScan:
    options = HeightScanOptions(name="scan", size=SIZE, **told)  # type: ignore[arg-type]  # of several types
    installed = installation(options, xyz=xyz, axes=turn, body=simulation.model.body("rover").id)
    return HeightScanSensor(simulation, installed, 5).read()


def from_above(
    model: mujoco.MjModel, data: mujoco.MjData, read: HeightScan, groups: tuple[int, ...]
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """The geoms that MuJoCo's rays down onto the middles of a scan's cells meet, and their heights."""
    along, across = np.meshgrid(0.1 * np.arange(16) - 0.75, 0.1 * np.arange(9) - 0.4, indexing="ij")
    x = read.x + math.cos(read.yaw) * along - math.sin(read.yaw) * across
    y = read.y + math.sin(read.yaw) * along + math.cos(read.yaw) * across
    down = np.array([[0.0, 0.0, -1.0]])
    places = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 10.0)])
    met = [meets(model, data, place, down, groups) for place in places]
    geoms, distances = np.array(met)[..., 0].T.reshape(2, 16, 9)
    return geoms.astype(np.int32), 10.0 - distances - read.z


@pytest.mark.parametrize("axes", ["rover", "world"])
def test_every_cell_has_the_height_of_what_is_met_first_from_above(
    simulation: Simulation, axes: str
) -> None:
    read = scan(simulation, (0.3, 0.1, 0.2), axes=axes)
    assert read.heights.shape == (16, 9)
    assert read.heights.dtype == np.float32
    assert (read.stamp_ns, read.sensor) == (simulation.time_ns, "scan")
    ahead = simulation.rotation()[:, 0]
    yaw = math.atan2(ahead[1], ahead[0]) if axes == "rover" else 0.0
    mount = np.array(simulation.position) + simulation.rotation() @ (0.3, 0.1, 0.2)
    assert (read.x, read.y, read.z) == pytest.approx(mount.tolist())
    assert read.yaw == pytest.approx(yaw)
    geoms, heights = from_above(simulation.model, simulation.data, read, (0, 1))
    assert read.heights == pytest.approx(heights, abs=2e-6)
    names = [simulation.model.geom(geom).name for geom in geoms.ravel().tolist()]
    assert 0 < sum(name.startswith("rock") for name in names) < read.heights.size / 2
    turn = Rotation.from_euler("xyz", (0.3, -0.2, 2.5)).as_matrix()
    ahead = simulation.rotation() @ turn[:, 0]  # a grid turns with its own frame
    yaw = math.atan2(ahead[1], ahead[0]) if axes == "rover" else 0.0
    assert scan(simulation, turn=turn, axes=axes).yaw == pytest.approx(yaw)


def test_what_hangs_high_and_what_reaches_in_from_afar_are_seen(make_simulation: MakeSimulation) -> None:
    boxes = [((0.26, 0.26, 0.3), (0.0, 0.0, 5.0)), ((1.0, 0.05, 0.2), (-1.2, 0.38, 0.2))]
    walls = tuple(Obstacle(ObstacleKind.HAZARD, "box", half, middle) for half, middle in boxes)
    read = scan(make_simulation("leo", obstacles=walls), axes="world")
    for (i, j), height in np.ndenumerate(read.heights):
        place = np.array([read.x - 0.75 + 0.1 * i, read.y - 0.4 + 0.1 * j])
        tops = [z + c for (a, b, c), (x, y, z) in boxes if (abs(place - (x, y)) < (a, b)).all()]
        assert height + read.z == pytest.approx(max(tops, default=0.0), abs=1e-6)


@pytest.mark.parametrize(("axis", "end"), [(0, 1), (0, -1), (1, 1), (1, -1)])
def test_what_is_off_the_map_is_not_known(axis: int, end: int) -> None:
    """On a map that does not lie around the origin; half of the grid lies beyond its edge."""
    ground = Heightfield(np.full((21, 21), 0.5), 0.5, (30.0, -7.0))
    world = World("aside", ground, (), seed=0, difficulty=None, start=(30.0, -7.0, 0.0))
    aside = Simulation(build_scene(world, LEO, 0.002), 2_000_000)
    assert np.isfinite(scan(aside, axes="world").heights).all()
    place = [0.0, 0.0, 0.0]
    place[axis] = 5.0 * end
    read = scan(aside, (place[0], place[1], 0.0), axes="world").heights
    heights = np.moveaxis(read, axis, 0)[::end]
    beyond = np.arange(len(heights)) > (len(heights) - 1) / 2
    assert np.isnan(heights[beyond]).all()
    assert np.isfinite(heights[: len(heights) // 2]).all()
