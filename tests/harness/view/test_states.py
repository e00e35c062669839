from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from harness.config import EpisodeConfig
from harness.episode.episode import Episode
from harness.errors import UsageError
from harness.view.states import StateWriter, read_states
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
    assert states.config.terrain == "rocky"
    assert states.joints.shape == (50, len(LEO.joints))


def test_half_a_state_at_the_end_is_left_out(tmp_path: Path) -> None:
    recorded(tmp_path / "states")
    (tmp_path / "states").write_bytes((tmp_path / "states").read_bytes()[:-5])
    assert len(read_states(tmp_path / "states").times) == 49


def test_what_is_no_recording_is_refused(tmp_path: Path) -> None:
    (tmp_path / "states").write_text("no recording\n")
    with pytest.raises(UsageError, match="is no recording of an episode"):
        read_states(tmp_path / "states")


def test_the_scene_is_made_from_the_same_place_of_the_same_file(tmp_path: Path) -> None:
    """The whole of it is too steep to stand on: only with its start it is a world."""
    np.save(tmp_path / "a.npy", np.tile(0.2 * np.arange(101.0), (101, 1)))
    config = EpisodeConfig(
        terrain=str(tmp_path / "a.npy"), terrain_size=(20.0, 20.0), start=(1.0, 2.0, 0.5)
    )
    with closing(StateWriter(tmp_path / "states", config)) as writer:
        writer._file.write(np.ones(8 + len(LEO.joints)).tobytes())
    again = read_states(tmp_path / "states").config
    assert (again.world().start, again.world().ground.half_size) == ((1.0, 2.0, 0.5), (10.0, 10.0))
