"""The process that draws: it starts with the first image, tries each OpenGL; failing costs a line."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from multiprocessing.connection import Connection
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.sensors.camera import painter
from harness.sensors.camera.painter import CameraPainter
from harness.sensors.camera.sensor import CameraState
from tests.harness.sensors.camera.staged import CAMERAS, EYE, coarse_scenery, looking, scenery

SEED = 5
STATE = CameraState(0, "pinhole", EYE, looking(), np.zeros(3))


class Threads:
    """In place of processes: what each does by the OpenGL that it is to use."""

    def __init__(self, acts: Mapping[str, Callable[[Connection], object]]) -> None:
        self.acts, self.started = acts, list[str]()
        self.Pipe = multiprocessing.Pipe

    def Process(self, *, target: object, args: tuple[Any, ...], daemon: bool) -> Any:  # noqa: N802, ANN401
        """A thread that looks like one."""
        assert (target, daemon) == (painter._serve, True)
        kind, told_scenery, cameras, seed, remote = args
        assert (told_scenery, cameras, seed) == (scenery, CAMERAS, SEED)
        mine = Connection(os.dup(remote.fileno()))

        def act() -> None:
            self.started.append(kind)
            with mine:
                self.acts[kind](mine)

        thread = threading.Thread(target=act)
        return SimpleNamespace(start=thread.start, join=thread.join, is_alive=thread.is_alive)


Paint = Callable[..., tuple[CameraPainter, Threads]]


@pytest.fixture
def told() -> list[str]:
    return []


@pytest.fixture
def paint(monkeypatch: pytest.MonkeyPatch, told: list[str]) -> Paint:
    def made(**acts: Callable[[Connection], object]) -> tuple[CameraPainter, Threads]:
        threads = Threads(acts)
        monkeypatch.setattr(multiprocessing, "get_context", lambda _: threads)
        monkeypatch.setattr(painter, "backends", lambda _: tuple(acts))
        return CameraPainter(scenery, CAMERAS, SEED, told.append), threads

    return made


def refuses(connection: Connection) -> None:
    connection.send("a camera needs OpenGL")


def draws(connection: Connection) -> None:
    """Images whose pixels are how many there were."""
    connection.send(None)
    for count in range(10):
        try:
            state = connection.recv()
        except EOFError:
            return
        options = CAMERAS[state.sensor]
        connection.send_bytes(bytes([count]) * (3 * options.width * options.height))


def dies(connection: Connection) -> None:
    connection.send(None)
    connection.recv()


def test_the_first_opengl_that_works_draws_and_nothing_starts_before_an_image_is_wanted(
    paint: Paint, told: list[str]
) -> None:
    subject, threads = paint(first=refuses, second=draws, third=draws)
    with subject:
        assert threads.started == []
        images = [np.asarray(subject.image(STATE)) for _ in range(3)]
    assert threads.started == ["first", "second"]
    assert [(image.shape, set(image.ravel().tolist())) for image in images] == [
        ((90, 120, 3), {n}) for n in range(3)
    ]
    assert told == []


@pytest.mark.parametrize(
    ("acts", "reason"),
    [
        ({"egl": refuses, "osmesa": refuses}, "a camera needs OpenGL"),
        ({"egl": lambda _: None, "osmesa": refuses}, "egl ended its process"),
        ({"egl": dies}, "the process that draws them has ended"),
    ],
)
def test_without_opengl_there_is_one_line_and_no_image(
    paint: Paint, told: list[str], acts: Mapping[str, Any], reason: str
) -> None:
    subject, threads = paint(**acts)
    with subject:
        assert [subject.image(STATE) for _ in range(3)] == [None] * 3
    assert threads.started == list(acts)
    assert told == [f"no images of pinhole, fisheye, noisy: {reason}; all else goes on"]


@pytest.mark.parametrize("fails", ["gl_context", "scenery"])
def test_what_a_process_cannot_do_it_says(fails: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> Any:  # noqa: ANN401 - it returns nothing
        raise UsageError("it is not there")

    opengl = "harness.physics.opengl.gl_context"
    monkeypatch.setattr(opengl, fail if fails == "gl_context" else lambda *_: None)
    monkeypatch.setenv("MUJOCO_GL", "off")
    here, there = multiprocessing.Pipe()
    with here, there:
        painter._serve("egl", fail, CAMERAS, SEED, there)
        assert here.recv() == "it is not there"
    assert os.environ["MUJOCO_GL"] == "egl"


@pytest.fixture
def real(told: list[str]) -> Iterator[CameraPainter]:
    with CameraPainter(coarse_scenery, CAMERAS, SEED, told.append) as subject:
        yield subject


def test_a_real_process_draws_and_its_end_is_told(real: CameraPainter, told: list[str]) -> None:
    from tests.harness.sensors.camera.test_renderer import state  # noqa: PLC0415 - loads MuJoCo

    image = real.image(state("pinhole", -0.15, -0.1))
    if image is None:
        pytest.skip(told[0])
    assert image.shape == (90, 120, 3)
    assert image[36, 76].sum() < 420 < image[10, 10].sum()  # the ball, the sky
    assert real._process is not None
    assert real._process.pid is not None
    os.kill(real._process.pid, signal.SIGKILL)
    assert real.image(state("pinhole")) is None
    assert real.image(state("pinhole")) is None
    (line,) = told
    assert "has ended; all else goes on" in line
