"""Readings of optional lidars and depth cameras in an episode, against closed forms."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from harness.sensors.mount import Mount

from harness.episode.episode import Episode
from harness.robots import RoverSpec, find_rover
from harness.sensors import choice
from harness.sensors.depth import DepthOptions
from harness.sensors.optional import Installation
from harness.sensors.range_sensor import RangeSensor
from harness.sensors.ranging import RangeReading
from harness.sensors.rays.bundle import Surroundings
from harness.spec.run import Run
from harness.world.obstacles import Obstacle, ObstacleKind
from tests.harness.conftest import MakeSimulation
from tests.harness.faults.faulty_ticks import said

LEVEL = {"kind": "depth", "parent": "base_link", "rpy": [0.0, 0.0, 0.0], "width": 8, "height": 6}
SMALL = {"kind": "lidar3d", "rings": 4, "columns": 30}


def readings(
    monkeypatch: pytest.MonkeyPatch, *entries: dict[str, Any], noise: str | None = None
) -> list[RangeReading]:
    """Of a short run on flat ground with these sensors."""

    def equipped(_: RoverSpec, asked: tuple[str, ...] | None) -> Any:  # noqa: ANN401 - rows
        return chosen(find_rover("leo").but(sensors=entries), asked)

    chosen = choice.chosen
    monkeypatch.setattr("harness.config.chosen", equipped)
    config = Run.of(terrain="flat", driver="spin", lidar_beams=8, duration=0.2, noise=noise)
    ticks = [tick for batch in Episode(config).batches() for tick in batch.ticks]
    return [sample for tick in ticks for sample in tick.samples if isinstance(sample, RangeReading)]


def test_the_depth_of_flat_ground_is_that_of_the_pinhole(monkeypatch: pytest.MonkeyPatch) -> None:
    """A level camera h above the plane sees it in row v at the depth h * f / (v - c)."""
    first, second = readings(monkeypatch, LEVEL | {"xyz": [0.0, 0.0, 0.4]})
    assert (first.stamp_ns, second.stamp_ns) == (100_000_000, 200_000_000)
    given = DepthOptions(name="depth", width=8, height=6)
    image, (_, middle) = first.ranges.reshape(6, 8), given.centre
    height = 0.19783 + 0.4  # of base_link over the ground, and of the camera over that
    below = np.arange(6) - middle
    assert (image[below < 0] == np.inf).all()
    expected = height * given.focal_length / below[below > 0]
    assert image[below > 0] == pytest.approx(np.tile(expected, (8, 1)).T, rel=5e-3)  # the tyres sink
    assert not first.on_obstacle.any()


def test_a_wall_ahead_has_the_same_depth_in_the_whole_image(make_simulation: MakeSimulation) -> None:
    wall = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 3.0, 3.0), (1.6, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    simulation = make_simulation(obstacles=(wall,))
    ahead = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # optical axes in the base's
    body = simulation.model.body("rover").id
    turn = simulation.data.xmat[body].reshape(3, 3)
    mount = Mount(body, turn.T @ ([0.1, 0.0, 0.9] - simulation.data.xpos[body]), turn.T @ ahead)
    given = DepthOptions(name="eye", width=6, height=4, fov=1.2, range_max=1.45)
    install = Installation(given, mount, np.random.default_rng(0))
    sensor = RangeSensor(simulation, Surroundings(simulation.model), install, 10)
    reading = sensor.read()
    simulation.data.qpos[0] -= 1.0
    assert not sensor.read().on_obstacle.any()  # which leaves the first reading as it is
    simulation.data.qpos[0] += 1.0
    assert reading.ranges == pytest.approx(np.full(24, 1.4, np.float32), abs=2e-3)
    assert reading.on_obstacle.all()
    near = replace(given, range_min=1.42)
    reading = RangeSensor(
        simulation, Surroundings(simulation.model), replace(install, options=near), 10
    ).read()
    assert (reading.ranges == -np.inf).all()


@pytest.mark.parametrize("noise", [None, "hardware"])
def test_the_same_seed_gives_the_same_readings_whatever_else_is_carried(
    monkeypatch: pytest.MonkeyPatch, noise: str | None
) -> None:
    """And two of a kind at one place differ by their errors alone."""
    own = SMALL | {"name": "top", "rate": 20}
    alone = readings(monkeypatch, own, noise=noise)
    both = readings(monkeypatch, SMALL, own, noise=noise)
    among = [reading for reading in both if reading.sensor == "top"]
    assert [r.ranges.tobytes() for r in alone] == [r.ranges.tobytes() for r in among]
    other = next(reading for reading in both if reading.sensor == "lidar3d")
    (beside,) = (reading for reading in among if reading.stamp_ns == other.stamp_ns)
    assert (beside.ranges.tobytes() == other.ranges.tobytes()) == (noise is None)
    exact = readings(monkeypatch, own)
    seen = np.isfinite(alone[0].ranges) & np.isfinite(exact[0].ranges)
    apart = alone[0].ranges[seen] - exact[0].ranges[seen]
    assert (apart.std() > 0.005) == (noise is not None)


def test_all_else_is_the_same_with_optional_sensors_and_without() -> None:
    config = Run.of(terrain="flat", lidar_beams=8, duration=0.2, noise="hardware")
    told = []
    for sensors in ((), ("lidar3d=livox", "depth")):
        batches = Episode(config.alone(sensors=sensors)).batches()
        ticks = [tick for batch in batches for tick in batch.ticks]
        others = [tuple(s for s in t.samples if not isinstance(s, RangeReading)) for t in ticks]
        told.append([said(replace(t, samples=some)) for t, some in zip(ticks, others, strict=True)])
    assert told[0] == told[1]


def test_noise_of_its_own_stands_before_that_of_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    (reading, _) = readings(monkeypatch, SMALL | {"noise": {"dropout": 1.0}}, noise="white")
    assert (reading.ranges == np.inf).all()
