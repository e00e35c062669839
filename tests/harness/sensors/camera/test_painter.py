"""The process that draws: it starts with the first image, tries each OpenGL; failing costs a line."""

import multiprocessing
import os
import signal
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.sensors.camera import painter
from harness.sensors.camera.painter import CameraPainter
from tests.harness.sensors.camera.staged import CAMERAS, coarse_scenery
from tests.harness.sensors.camera.test_renderer import state
from tests.support.forking import ForkServer

SEED, IMAGE = 5, state("pinhole", -0.15, -0.1)


def no_scenery() -> Any:  # noqa: ANN401 - it returns nothing
    """Of a world whose file has gone since the run began."""
    raise UsageError(f"no world for OpenGL {os.environ['MUJOCO_GL']}")


def test_the_first_opengl_that_works_draws_until_its_process_ends_and_the_end_is_one_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lines: list[str] = []
    before = set(multiprocessing.active_children())
    monkeypatch.setattr(painter, "backends", lambda _: ("cgl", "egl", "osmesa"))
    with CameraPainter(coarse_scenery, CAMERAS, SEED, lines.append) as subject:
        assert set(multiprocessing.active_children()) == before, "nothing starts before it is wanted"
        image = subject.image(IMAGE)
        if image is None:
            pytest.skip(lines[0])
        assert image.shape == (90, 120, 3)
        assert image[36, 76].sum() < 420 < image[10, 10].sum()  # the ball, the sky
        noisy = subject.image(state("noisy", -0.15, -0.1))
        assert noisy is not None
        of_the_seed = np.random.default_rng((SEED, [*CAMERAS].index("noisy"), IMAGE.stamp_ns))
        drawn = of_the_seed.normal(size=image.shape)
        assert np.corrcoef((noisy.astype(float) - image).ravel(), drawn.ravel())[0, 1] > 0.5
        (drawing,) = set(multiprocessing.active_children()) - before
        assert drawing.pid is not None
        os.kill(drawing.pid, signal.SIGKILL)
        assert [subject.image(IMAGE) for _ in range(2)] == [None, None]
    assert set(multiprocessing.active_children()) == before
    (line,) = lines
    assert line.startswith("no images of pinhole, fisheye, noisy, noisy_too: ")
    assert line.endswith("has ended; all else goes on")


def test_without_an_image_there_is_one_line_with_the_first_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With what are no names of an OpenGL the world is missing."""
    lines: list[str] = []
    monkeypatch.setattr(painter, "multiprocessing", ForkServer())
    monkeypatch.setattr(painter, "backends", lambda _: ("one", "two"))
    with CameraPainter(no_scenery, CAMERAS, SEED, lines.append) as subject:
        assert (subject.image(IMAGE), subject.image(IMAGE)) == (None, None)
    (line,) = lines
    assert "OpenGL one" in line or "needs OpenGL" in line
    assert line.endswith("all else goes on")
    assert "\n" not in line
