import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from harness.config import EpisodeConfig
from harness.episode.episode import Episode
from harness.errors import UsageError
from harness.files import whole_file
from harness.physics.scene import build_scene
from harness.run import main
from harness.view.camera import best_view, chase_view
from harness.view.drawing import Drawing
from harness.view.marks import beam_marks, path_marks, track_marks
from harness.view.states import States, StateWriter, read_states
from tests.support.rovers import LEO

CONFIG = EpisodeConfig(terrain="rocky", driver="straight", duration=2.0)
RUN = ["--direct", "--terrain", "flat", "--duration", "1"]


@cache
def why_no_opengl() -> str | None:
    """The reason why nothing can be drawn here, or None."""
    try:
        with Drawing(Path("x.png"), None, lidar=False) as drawing:
            drawing.prepare(CONFIG)
    except UsageError as error:
        return str(error)
    return None


@pytest.fixture
def _opengl() -> None:
    if (reason := why_no_opengl()) is not None:
        pytest.skip(reason)


def recorded(path: Path, config: EpisodeConfig = CONFIG) -> States:
    with StateWriter(path, config) as writer:
        for batch in Episode(config).batches():
            writer.take(batch)
    return read_states(path)


def test_states_are_those_of_the_episode(tmp_path: Path) -> None:
    episode = Episode(CONFIG)
    with StateWriter(tmp_path / "states", CONFIG) as writer:
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


def test_best_view_shows_the_path_and_stands_over_the_ground(tmp_path: Path) -> None:
    states = recorded(tmp_path / "states")
    world = CONFIG.world()
    episode = Episode(CONFIG)
    model = build_scene(world, LEO, 0.0025).model
    view = best_view(model, episode.simulation.data, states.path, states.yaw[-1], 0.7)
    assert view.sees(states.path, 0.7).all()
    assert view.eye[2] > world.ground.height_at(*view.eye[:2])


def test_chase_view_looks_where_the_rover_heads() -> None:
    view = chase_view(np.zeros(3), 0.0)
    assert view.direction[0] > 0.7
    assert view.eye[0] < 0.0 < view.eye[2]


def test_a_file_is_there_whole_or_not_at_all(tmp_path: Path) -> None:
    target = tmp_path / "a.png"

    def fail() -> None:
        with whole_file(target) as part:
            part.write_text("half")
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("flags", "expected"),
    [
        (["--picture", "a.jpg"], "--picture 'a.jpg': name a file that ends in .png"),
        (["--picture", ""], "name a file that ends in .png"),
        (["--video", "a.avi"], "--video 'a.avi': name a file that ends in .mp4"),
        (["--picture", "/nowhere/a.png"], "there is no folder /nowhere; create it first"),
        (["--picture", "/proc/a.png"], "--picture /proc/a.png: /proc is not writable"),
        (["--picture", "a" * 300 + ".png"], "File name too long"),
        (["--picture-lidar"], "--picture-lidar needs --picture or --video"),
    ],
)
def test_impossible_picture_is_refused_before_the_run(
    flags: list[str], expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*RUN, "--log-dir", str(tmp_path), *flags]) == 2
    complaint = capsys.readouterr().err
    assert expected in complaint
    assert complaint.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_folder_named_like_a_picture_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.png").mkdir()
    assert main([*RUN, "--picture", str(tmp_path / "a.png")]) == 2
    assert "is a folder; name a file" in capsys.readouterr().err


TWO_RUNS = """
import sys
from harness.run import main
picture, *words = sys.argv[1:]
print(main([*words, "--picture", picture]), main(words))
"""


def test_missing_opengl_is_one_line_that_names_the_packages_and_only_pictures_need_it(
    tmp_path: Path,
) -> None:
    logs = tmp_path / "logs"
    environment = {k: v for k, v in os.environ.items() if k not in {"DISPLAY", "WAYLAND_DISPLAY"}}
    done = subprocess.run(
        [sys.executable, "-c", TWO_RUNS, str(tmp_path / "a.png"), *RUN, "--log-dir", str(logs)],
        env=environment | {"MUJOCO_GL": "nonsense"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "2 0"
    assert "MUJOCO_GL=nonsense does not work here; install libegl1" in done.stderr
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == [logs]
    assert len(list(logs.glob("*.csv"))) == 1


@pytest.mark.usefixtures("_opengl")
def test_run_draws_its_picture_and_its_bytes_stay_the_same(tmp_path: Path) -> None:
    words = ["--direct", "--terrain", "posts", "--driver", "straight", "--duration", "6", "--log-dir"]
    assert main([*words, str(tmp_path / "plain")]) == 0
    picture = tmp_path / "a.png"
    flags = ["--picture", str(picture), "--picture-lidar"]
    assert main([*words, str(tmp_path / "drawn"), *flags]) == 0
    (plain,), (drawn,) = ((tmp_path / name).glob("*.csv") for name in ("plain", "drawn"))
    assert plain.read_bytes() == drawn.read_bytes()
    with Image.open(picture) as image:
        assert image.size == (1280, 640)
        pixels = np.asarray(image).astype(int)
    red, green, blue = pixels.transpose(2, 0, 1)
    assert 80 < pixels.mean() < 180
    assert ((blue > 180) & (green > 150) & (red < 90)).sum() > 500  # the path
    assert ((red > 200) & (green < 90)).sum() > 50  # the lidar's hits


@pytest.mark.usefixtures("_opengl")
def test_run_draws_its_video(tmp_path: Path) -> None:
    av = pytest.importorskip("av", reason="the extra [video] is not installed")
    video = tmp_path / "a.mp4"
    words = ["--direct", "--terrain", "flat", "--duration", "0.12", "--log-dir", str(tmp_path)]
    assert main([*words, "--video", str(video)]) == 0
    with av.open(str(video)) as container:
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    assert len(frames) == 3
    assert frames[0].shape == (480, 960, 3)
    assert 60 < np.mean(frames[-1]) < 200
