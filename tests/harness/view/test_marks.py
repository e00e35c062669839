from pathlib import Path

import numpy as np
import pytest

from harness.episode.assembly import world_of
from harness.view.marks import beam_marks, path_marks, track_marks
from tests.harness.view.recorded import CONFIG, recorded
from tests.support.rovers import LEO


def test_path_lies_on_the_ground_and_grows_with_time(tmp_path: Path) -> None:
    states = recorded(tmp_path / "states")
    ground = world_of(CONFIG).ground
    marks = path_marks(states, ground)
    assert len(marks) > 5
    for mark in marks:
        assert abs(mark.position[2] - ground.height_at(*mark.position[:2])) < 0.02
    times = [mark.since for mark in marks]
    assert times == sorted(times)
    assert 0.0 < times[0] < times[-1] <= 2.0


def test_tracks_are_as_far_apart_as_the_wheels(tmp_path: Path) -> None:
    states = recorded(tmp_path / "states")
    left, right, *_ = track_marks(states, world_of(CONFIG).ground, LEO)
    across = LEO.track * np.array([-np.sin(states.yaw[0]), np.cos(states.yaw[0])])
    assert (left.position - right.position)[:2] == pytest.approx(across, abs=0.02)


def test_only_beams_that_hit_are_drawn() -> None:
    directions = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    marks = beam_marks(np.zeros(3), directions, np.array([2.0, np.inf, -np.inf], np.float32))
    hit, beam = marks
    np.testing.assert_allclose(hit.position, (2.0, 0.0, 0.0))
    assert beam.end is not None
    np.testing.assert_allclose([*beam.position, *beam.end], (0.0, 0.0, 0.0, 2.0, 0.0, 0.0))


def test_many_beams_hide_nothing_every_hit_is_shown_and_few_lines() -> None:
    angles = np.linspace(-np.pi, np.pi, 640, endpoint=False)
    directions = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(640)])
    ranges = np.full(640, 3.0, np.float32)
    marks = beam_marks(np.zeros(3), directions, ranges)
    ends = np.array([mark.end for mark in marks if mark.end is not None])
    assert len(marks) - len(ends) == 640
    assert 36 <= len(ends) <= 72
    bearings = np.arctan2(ends[:, 1], ends[:, 0])
    np.testing.assert_allclose(np.diff(bearings), np.diff(bearings)[0], atol=1e-6)  # evenly spread
