import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from unittest.mock import MagicMock

import numpy as np
import pytest
from PIL import Image

from harness.base.errors import UsageError
from harness.base.interrupt import Interrupted, StopRequest
from harness.episode.assembly import fleet
from harness.episode.episode import episodes_of
from harness.episode.together import Together
from harness.run import main
from harness.spec.fleet import parse_rovers
from harness.spec.run import Run
from harness.view import artist
from harness.view.drawing import Drawing
from harness.view.states import read_states
from tests.support.complaint import without_progress

RUN = ["--direct", "--terrain", "flat", "--duration", "1"]


# Smooth edges, sharp shadows and many frames take most of the time.
COARSE = """
import sys
from dataclasses import replace
from harness.view import picture
picture.QUALITY = replace(picture.QUALITY, samples=0, shadow_map=512)
picture.VIDEO_QUALITY = replace(picture.VIDEO_QUALITY, samples=0, shadow_map=512)
picture.MOST_FRAMES = 2
sys.exit(picture.main())
"""


TWO_RUNS = """
import sys
from harness.run import main
picture, *words = sys.argv[1:]
print(main([*words, "--picture", picture]), main(words))
"""


def test_missing_opengl_is_one_line_and_only_pictures_need_it(tmp_path: Path) -> None:
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
    (told,) = without_progress(done.stderr)
    assert "MUJOCO_GL=nonsense does not work here; install libegl1" in told
    assert list(tmp_path.iterdir()) == [logs]
    assert len(list(logs.glob("*.csv"))) == 1


INTERRUPTING = """
import os, signal, sys
open(sys.argv[1], "w").write(str(os.getpid()))
os.kill(os.getppid(), signal.SIGINT)
input()
"""


def test_a_signal_while_what_draws_is_started_leaves_no_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pid = tmp_path / "pid"
    monkeypatch.setattr(artist, "PROGRAM", (sys.executable, "-c", INTERRUPTING, str(pid)))
    with pytest.raises(Interrupted) as error, StopRequest():
        artist.Artist(dict(os.environ))
    assert not Path(f"/proc/{pid.read_text()}").exists(), error


def test_of_a_fleet_the_states_of_each_rover_are_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    draws = MagicMock()
    monkeypatch.setattr("harness.view.drawing.artist", lambda _: draws)
    run = Run.of(terrain="flat", duration=0.2, lidar_beams=2)
    two = fleet(run, parse_rovers(("leo:a", "rover_zero4wd:b,x=3,y=-2"), run.rover))
    with Drawing(tmp_path / "a.png", None, lidar=False) as drawing:
        drawing.prepare(two)
        for batches in Together(episodes_of(two)).batches():
            for observer, batch in zip(drawing.observers, batches, strict=True):
                observer.take(batch)
        drawing.begin()
        (order,) = draws.__enter__.return_value.begin.call_args.args
        drawn = [read_states(Path(path)) for path in order["recordings"]]
    assert [states.run.rovers[states.number] for states in drawn] == list(two.rovers)
    assert [states.path[0, :2].tolist() for states in drawn] == [
        pytest.approx(place, abs=0.05) for place in ([0.0, 0.0], [3.0, -2.0])
    ]


def test_what_is_to_be_drawn_and_from_where_reaches_what_draws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.cli.run_command.keep_opengl_out", lambda: "osmesa")
    monkeypatch.setattr("harness.view.drawing.artist", draws := MagicMock())
    files = {"--picture": str(tmp_path / "a.png"), "--video": str(tmp_path / "b.mp4")}
    words = [word for pair in files.items() for word in pair]
    more = ["--picture-lidar", "--camera", "top"]
    assert main([*RUN, "--log-dir", str(tmp_path), *words, *more]) == 0
    (order,) = draws.return_value.__enter__.return_value.begin.call_args.args
    look = (order["files"], order["camera"], order["lidar"])
    assert (draws.call_args.args, look) == (("osmesa",), (files, "top", True))


def test_a_run_draws_its_picture_and_its_video_and_its_log_keeps_its_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    av = pytest.importorskip("av", reason="the extra [video] is not installed")
    try:
        artist.artist("").__exit__()
    except UsageError as error:
        pytest.skip(str(error))
    monkeypatch.setattr(artist, "PROGRAM", (sys.executable, "-c", COARSE))
    shown: list[tuple[int, int]] = []
    finish = Drawing.finish

    def told(one: Drawing, show: Callable[[int, int], None]) -> list[Path]:
        show(0, 1)  # what the bar takes
        return finish(one, lambda done, total: shown.append((done, total)))

    monkeypatch.setattr(Drawing, "finish", told)
    words = ["--direct", "--terrain", "posts", "--driver", "straight", "--duration", "4", "--log-dir"]
    assert main([*words, str(tmp_path / "plain")]) == 0
    picture, video = tmp_path / "<script>[b]$x$.png", tmp_path / "a.mp4"
    flags = ["--picture", str(picture), "--picture-lidar", "--video", str(video)]
    assert main([*words, str(tmp_path / "drawn"), *flags]) == 0
    (plain,), (drawn,) = ((tmp_path / name).glob("*.csv") for name in ("plain", "drawn"))
    assert plain.read_bytes() == drawn.read_bytes()
    assert shown == [(0, 1), (1, 1), (0, 2), (1, 2), (2, 2)]
    with Image.open(picture) as image:
        assert image.size == (1280, 640)
        pixels = np.asarray(image).astype(int)
    red, green, blue = pixels.transpose(2, 0, 1)
    assert 80 < pixels.mean() < 180
    assert ((blue > 180) & (green > 150) & (red < 90)).sum() > 500  # the path
    assert ((red > 220) & (green < 60) & (blue < 60)).sum() > 50  # the lidar's hits
    with av.open(str(video)) as container:
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    assert [frame.shape for frame in frames] == [(480, 960, 3)] * 2
    assert 60 < np.mean(frames[-1]) < 200
    assert (frames[-1][435:465, 20:220] > 190).all(axis=2).sum() > 100  # white text in the corner
