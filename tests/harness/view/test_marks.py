from pathlib import Path

import numpy as np
import pytest

from harness.view.marks import beam_marks, path_marks, track_marks
from tests.harness.view.recorded import CONFIG, recorded
from tests.support.rovers import LEO


def test_path_lies_on_the_ground_and_grows_with_time(tmp_path: Path) -> None:
    states = recorded(tmp_path / "states")
    ground = CONFIG.world().ground
    marks = path_marks(states, ground)
    assert len(marks) > 5
    for mark in marks:
        assert abs(mark.position[2] - ground.height_at(*mark.position[:2])) < 0.02
    times = [mark.since for mark in marks]
    assert times == sorted(times)
    assert 0.0 < times[0] < times[-1] <= 2.0


def test_tracks_are_as_far_apart_as_the_wheels(tmp_path: Path) -> None:
    states = recorded(tmp_path / "states")
    left, right, *_ = track_marks(states, CONFIG.world().ground, LEO)
    assert np.hypot(*(left.position - right.position)[:2]) == pytest.approx(LEO.track)


def test_only_beams_that_hit_are_drawn() -> None:
    directions = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    marks = beam_marks(np.zeros(3), directions, np.array([2.0, np.inf, -np.inf], np.float32))
    assert len(marks) == 2  # the line and its end
    np.testing.assert_allclose(marks[1].position, (2.0, 0.0, 0.0))
