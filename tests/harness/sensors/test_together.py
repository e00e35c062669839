"""Sensors of the table in whole episodes, with what else a run has: faults, noise, maps of files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from scipy.spatial.transform import Rotation

from harness.episode.assembly import injector
from harness.episode.episode import Episode
from harness.frames.rover_frames import rover_frames
from harness.robots import ROVERS, RoverSpec
from harness.samples import Odometry, Pose, Tick, Transforms
from harness.sensors.magnetometer import MagneticField
from harness.sensors.optional import SensorOptions
from harness.sensors.ranging import RangeReading
from harness.spec.ros import FrameOptions
from harness.spec.run import Run
from harness.spec.sensor import parse_choice
from harness.world.geodesy import Datum


def ticks(run: Run, options: FrameOptions | None = None) -> list[Tick]:
    """All that the rover of a run sends, with its faults."""
    faults = injector(run)
    episode = Episode(run, frame_options=options)
    return [faults.corrupt(tick) for batch in episode.batches() for tick in batch.ticks]


def of(kind: type[Any], sent: list[Tick]) -> list[Any]:
    return [sample for tick in sent for sample in tick.samples if isinstance(sample, kind)]


def carrying(*sensors: str, **values: Any) -> Run:  # noqa: ANN401 - fields of a run
    return Run.of(sensors=tuple(map(parse_choice, sensors)), lidar_beams=9, **values)


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_what_nobody_mounts_is_where_the_model_has_its_lidar(rover: RoverSpec) -> None:
    given = SensorOptions(name="eye")
    frames = rover_frames(rover.but(lidar_height=7.0), given.frames(rover.but(lidar_height=7.0)))
    (eye,) = (link for link in frames.links if link.name == "eye_link")
    assert eye.in_base[:3, 3] == pytest.approx(frames.data.site("lidar").xpos, abs=1e-12)
    assert eye.in_base[:3, :3] == pytest.approx(np.eye(3))


def test_a_lost_pixel_a_miss_and_what_a_fault_makes_of_them_can_be_told_apart() -> None:
    """Hardware loses 1 % of what is met; the fault turns a third of all values into infinity."""
    shared = {"terrain": "posts", "duration": 1.0, "noise": "hardware"}
    clean = np.array([r.ranges for r in of(RangeReading, ticks(carrying("depth", **shared)))])
    faulty = carrying("depth", faults=("depth:inf=0.3",), **shared)
    read = np.array([r.ranges for r in of(RangeReading, ticks(faulty))])
    met = np.isfinite(clean) | np.isnan(clean)
    assert np.isnan(clean).sum() / met.sum() == pytest.approx(0.01, abs=0.002)
    assert np.isposinf(read).mean() - 0.7 * np.isposinf(clean).mean() == pytest.approx(0.3, abs=0.01)
    kept = ~np.isposinf(read)
    np.testing.assert_array_equal(read[kept], clean[kept])


def test_a_compass_on_a_map_from_a_file_shows_the_field_of_its_datum(tmp_path: Path) -> None:
    rough = np.random.default_rng(0).normal(0.0, 0.02, (41, 41))
    tifffile.imwrite(tmp_path / "hill.tif", rough.astype(np.float32))
    datum = (-33.9, 18.4, 40.0)
    run = carrying("magnetometer", terrain=str(tmp_path / "hill.tif"), datum=datum, duration=0.6)
    run = run.but(world=run.world.but(terrain_size=(12.0, 12.0)))
    sent = ticks(run)
    poses = {pose.stamp_ns: pose for pose in of(Pose, sent)}
    field = Datum(*datum).magnetic_field(2026.0)
    read = [one for one in of(MagneticField, sent) if one.stamp_ns in poses]
    assert read
    for one in read:
        turn = Rotation.from_quat(poses[one.stamp_ns].orientation)
        assert turn.apply(one.magnetic_field) == pytest.approx(field, abs=1e-10)


def test_odometry_of_tyres_that_are_not_as_believed_and_its_transform_agree() -> None:
    """Straight ahead: each seed has its own radii, of half a percent; a rover at rest goes nowhere."""
    ways = []
    for seed in range(12):
        shared = {"terrain": "flat", "duration": 1.0, "seed": seed, "lidar_beams": 9}
        sent = [
            ticks(Run.of(driver="straight", noise=noise, **shared), FrameOptions(odom_tf="wheels"))
            for noise in ("hardware", None)
        ]
        noisy, exact = (of(Odometry, some)[-1] for some in sent)
        ways.append(exact.x / noisy.x)
        told = {one.stamp_ns: one.translation[:2] for one in of(Transforms, sent[0])}
        assert told[noisy.stamp_ns] == pytest.approx((noisy.x, noisy.y), abs=1e-12)
    assert np.std(ways) == pytest.approx(0.005 / 2**0.5, rel=0.6)
    assert np.mean(ways) == pytest.approx(1.0, abs=0.004)
