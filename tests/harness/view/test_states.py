from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.episode.assembly import world_of
from harness.episode.episode import Episode
from harness.spec.run import Run
from harness.view.states import States, StateWriter, read_states
from tests.harness.view.recorded import CONFIG, recorded
from tests.support.rovers import LEO


def test_states_are_those_of_the_episode(tmp_path: Path) -> None:
    episode = Episode(CONFIG)
    with closing(StateWriter(tmp_path / "states", CONFIG)) as writer:
        for batch in episode.batches():
            writer.take(batch)
    states = read_states(tmp_path / "states")
    np.testing.assert_allclose(states.times, np.arange(1, 51) * 0.04)
    np.testing.assert_array_equal(states.path[-1], episode.simulation.data.qpos[:3])
    np.testing.assert_array_equal(states.orientations[-1], episode.simulation.data.qpos[3:7])
    assert states.run.world.terrain == "rocky"
    assert states.joints.shape == (50, len(LEO.joints))


def test_people_are_where_they_were_last_told_to_be(tmp_path: Path) -> None:
    config = CONFIG.alone(terrain="flat", actors=("a=1,1", "g=3,0/3,4"))
    states = recorded(tmp_path / "states", config)
    np.testing.assert_allclose(states.people[:, 0], np.tile([1.0, 1.0, 0.875, 0.0], (50, 1)))
    np.testing.assert_allclose(states.people[:, 1, 1], states.times, atol=0.031)  # 1 m/s along y
    np.testing.assert_allclose(states.people[:, 1, 3], np.pi / 2)
    assert states.people[0, 1, 1] == pytest.approx(0.04)


def test_speed_is_the_path_over_half_a_second_around_a_state() -> None:
    kept = np.delete(np.arange(1, 101), slice(40, 43))  # a fault took three states
    times = np.asarray(kept * 0.04, dtype=np.float64)
    angle, climb = 0.5 * times, 0.3 * times  # a helix of radius 2 m: sqrt(1 + 0.09) m/s
    path = np.column_stack([2.0 * np.cos(angle), 2.0 * np.sin(angle), climb])
    states = States(CONFIG, 0, times, path, np.zeros((97, 4)), np.zeros((97, 4)), np.zeros((97, 0, 4)))
    np.testing.assert_allclose(states.speed, np.sqrt(1.09), rtol=1e-3)
    stands = np.where(times[:, None] < 2.0, path, path[times >= 2.0][0])
    speed = replace(states, path=stands).speed  # it stops at 2 s
    assert (speed[times > 2.3] == 0.0).all()
    np.testing.assert_allclose(speed[times < 1.7], np.sqrt(1.09), rtol=1e-3)
    assert 0.3 < speed[np.argmin(abs(times - 2.0))] < 0.7
    first = replace(states, times=times[:1], path=path[:1])
    assert first.speed.tolist() == [0.0]


def test_heading_does_not_leap_where_a_turn_is_whole(tmp_path: Path) -> None:
    states, turns = recorded(tmp_path / "states"), np.linspace(0.0, 15.0, 50)
    spin = np.column_stack([np.cos(turns / 2), 0 * turns, 0 * turns, np.sin(turns / 2)])
    np.testing.assert_allclose(replace(states, orientations=spin).yaw, turns, atol=1e-9)


def test_half_a_state_at_the_end_is_left_out_and_what_is_no_recording_refused(tmp_path: Path) -> None:
    recorded(tmp_path / "states")
    whole, size = (tmp_path / "states").read_bytes(), 8 * (8 + len(LEO.joints))
    (tmp_path / "states").write_bytes(whole + np.full(size // 8, np.nan).tobytes())  # as it diverges
    assert len(read_states(tmp_path / "states").times) == 50
    (tmp_path / "states").write_bytes(whole[:-5])
    assert len(read_states(tmp_path / "states").times) == 49
    (tmp_path / "states").write_text("no recording\n")
    with pytest.raises(UsageError, match="is no recording of an episode"):
        read_states(tmp_path / "states")


def test_the_scene_is_made_from_the_same_place_of_the_same_file(tmp_path: Path) -> None:
    """The whole of it is too steep to stand on: only with its start it is a world."""
    np.save(heights := tmp_path / "<script>[b]$x$.npy", np.tile(0.2 * np.arange(101.0), (101, 1)))
    config = Run.of(terrain=str(heights), terrain_size=(20.0, 20.0), start=(1.0, 2.0, 0.5))
    with closing(StateWriter(tmp_path / "states", config)) as writer:
        writer._file.write(np.ones(8 + len(LEO.joints)).tobytes())
    again = world_of(read_states(tmp_path / "states").run)
    assert (again.start, again.ground.half_size) == ((1.0, 2.0, 0.5), (10.0, 10.0))
