"""Which OpenGL is taken, and what is said where there is none."""

from types import SimpleNamespace

import pytest

from harness.base.errors import UsageError
from harness.physics import opengl


@pytest.mark.parametrize(
    ("chosen", "tried"),
    [("", ["egl", "osmesa"]), ("off", ["egl", "osmesa"]), ("EGL", ["egl"]), (" osmesa ", ["osmesa"])],
)
def test_the_first_that_works_is_taken_unless_one_is_asked_for(
    chosen: str, tried: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only OSMesa is there."""
    asked: list[str] = []

    def load(name: str) -> SimpleNamespace:
        asked.append(name.removeprefix("mujoco."))
        if name != "mujoco.osmesa":
            raise ImportError(name)
        return SimpleNamespace(GLContext=lambda *size: size)

    monkeypatch.setattr(opengl, "import_module", load)
    monkeypatch.setenv("MUJOCO_GL", chosen)
    if tried[-1] == "osmesa":
        assert opengl.gl_context("a picture", 3, 4) == (3, 4)
    else:
        with pytest.raises(UsageError, match=r"^a picture needs OpenGL, and none works here; install"):
            opengl.gl_context("a picture", 3, 4)
    assert asked == tried
