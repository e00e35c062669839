"""Faults of sensors that a rover names itself."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.episode.assembly import actuator_faults, check, injector
from harness.episode.episode import Episode
from harness.spec.run import Run
from tests.harness.robots.test_model import brought_along


def test_a_sensor_has_faults_under_the_name_that_its_rover_gives_it(tmp_path: Path) -> None:
    rover = brought_along(tmp_path / "car")
    text = (rover / "rover.yaml").read_text()
    named = "sensors: [{kind: lidar2d, name: front}, {kind: camera, name: eye}]\n"
    (rover / "rover.yaml").write_text(text + named)
    run = Run.of(terrain="flat", robot=str(rover), faults=["front:nan"], duration=0.2)
    check(run)
    actuator_faults(run, 0)
    faults, ticks = injector(run), [tick for one in Episode(run).batches() for tick in one.ticks]
    samples: list[Any] = [sample for tick in ticks for sample in faults.corrupt(tick).samples]
    ranges = [each.ranges for each in samples if getattr(each, "sensor", "") == "front"]
    assert len(ranges) == 2
    assert np.isnan(ranges).all()
    for fault, said in (("eye:nan", "eye has no fault 'nan'"), ("lidar2d:nan", "no sensor 'lidar2d'")):
        with pytest.raises(UsageError, match=said):
            check(run.alone(faults=[fault]))
