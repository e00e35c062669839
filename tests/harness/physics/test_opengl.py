"""Which OpenGL is taken, and what is said where there is none."""

from types import SimpleNamespace

import pytest

from harness.base.errors import UsageError
from harness.physics import opengl
from harness.physics.opengl import gl_context


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The modules that were tried; only OSMesa is there."""
    tried: list[str] = []

    def load(name: str) -> SimpleNamespace:
        tried.append(name)
        if name != "mujoco.osmesa":
            raise ImportError(name)
        return SimpleNamespace(GLContext=lambda *size: (name, size))

    monkeypatch.setattr(opengl, "import_module", load)
    return tried


@pytest.mark.parametrize("chosen", ["", "off", " "])
def test_the_first_that_works_is_taken(
    chosen: str, asked: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MUJOCO_GL", chosen)
    assert gl_context("a picture", 3, 4) == ("mujoco.osmesa", (3, 4))
    assert asked == ["mujoco.egl", "mujoco.osmesa"]


def test_the_one_that_is_asked_for_is_not_replaced(
    asked: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MUJOCO_GL", "EGL")
    monkeypatch.setattr("platform.system", lambda: "Linux")
    with pytest.raises(
        UsageError, match=r"^a picture needs OpenGL, and none works here; install libegl1"
    ):
        gl_context("a picture", 3, 4)
    assert asked == ["mujoco.egl"]
