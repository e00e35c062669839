"""Sensors of the table in whole episodes, with what else a run has: faults, noise, maps of files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from scipy.spatial.transform import Rotation

from harness.episode.assembly import injector
from harness.episode.episode import Episode
from harness.robots import ROVERS, RoverSpec
from harness.robots.frames.rover_frames import rover_frames
from harness.samples import Pose, Tick
from harness.sensors.magnetometer import MagneticField
from harness.sensors.optional import SensorOptions
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
