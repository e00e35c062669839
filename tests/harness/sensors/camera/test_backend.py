"""Which OpenGL is tried on which system."""

import os

import pytest

from harness.sensors.camera.backend import backends, keep_opengl_out


@pytest.mark.parametrize(
    ("system", "chosen", "expected"),
    [
        ("Linux", "", ("egl", "osmesa")),
        ("Darwin", "", ("cgl", "glfw")),
        ("Windows", "", ("glfw",)),
        ("FreeBSD", "", ("egl", "osmesa")),
        ("Linux", "osmesa", ("osmesa",)),
    ],
)
def test_each_system_has_its_own_unless_one_is_chosen(
    system: str, chosen: str, expected: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("platform.system", lambda: system)
    assert backends(chosen) == expected


def test_what_was_asked_for_at_first_is_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", " EGL ")
    keep_opengl_out.cache_clear()
    assert [keep_opengl_out(), keep_opengl_out()] == ["egl", "egl"]
    assert os.environ["MUJOCO_GL"] == "off"
    keep_opengl_out.cache_clear()
