"""Which OpenGL is tried on which system."""

import pytest

from harness.sensors.camera.backend import backends


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
