from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from gymnasium.error import ResetNeeded

from harness.base.errors import UsageError
from harness.gym import picture
from harness.physics import opengl
from harness.physics.opengl import gl_context
from harness.view.live.watch import Watch
from harness.view.marks import add_marks
from harness.world.heightfield import Heightfield
from tests.harness.gym.conftest import Make
from tests.harness.gym.test_vector import YARD

QUICK = replace(picture.QUALITY, samples=0, shadow_map=256)  # without OpenGL's hardware a second each


@pytest.fixture
def drawing(make: Make, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    monkeypatch.setattr("harness.physics.stage.SOIL_PIXELS", 64)  # the soil's grain takes a second
    monkeypatch.setattr(picture, "QUALITY", QUICK)
    try:
        gl_context("a picture", 16, 16).free()
    except UsageError as error:
        pytest.skip(str(error))
    return make


def is_blueish(image: Any) -> Any:  # noqa: ANN401 - arrays
    """Where the goal is: nothing else on Mars is."""
    return (image[..., 2].astype(int) - image[..., 0]) > 40


def test_an_image_shows_the_rover_from_behind_and_the_goal_on_the_ground(
    drawing: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    marked = Mock(wraps=add_marks)
    monkeypatch.setattr(picture, "add_marks", marked)
    env = drawing(render_mode="rgb_array", random_start=False)
    turned = {"start": (0.0, 0.0, np.pi / 2), "goal": (0.5, 4.0)}  # ahead, a little to the right
    with pytest.raises(ResetNeeded, match="nothing to draw yet"):
        env.render()
    env.reset(seed=0, options=turned)
    image = env.render()
    assert np.array_equal(env.render(), image)  # the first has the same light
    assert (image.shape, image.dtype) == ((400, 640, 3), np.uint8)
    blueish = is_blueish(image)
    assert blueish.sum() > 200, blueish.sum()
    height, width = np.ptp(np.nonzero(blueish)[0]), blueish.sum(axis=1).max()
    assert height > 8 * width, (height, width)  # 1.2 m of it above the ground, 0.1 m thick, from above
    (_, (post,), _), _ = marked.call_args
    ground = env.course.scene.world.ground
    assert post.position == pytest.approx([0.5, 4.0, ground.height_at(0.5, 4.0) + 0.6])
    env.reset(options={"goal": (-6.0, 0.0)})  # behind the camera
    assert not is_blueish(env.render()).any()
    env.close()
    env.close()


def test_who_does_not_draw_needs_no_opengl_and_is_told(make: Make) -> None:
    env = make()
    env.reset(seed=0)
    with pytest.warns(UserWarning, match="draws nothing without render_mode"):
        assert env.render() is None
    env.close()


def test_without_opengl_or_display_the_mend_is_told(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    env = make(render_mode="rgb_array")
    env.reset(seed=0)
    monkeypatch.setattr(opengl, "CONTEXTS", ("mujoco.nothing",))
    with pytest.raises(UsageError, match="'rgb_array' needs OpenGL, and none works here; install"):
        env.render()
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    for display in ("", ":none"):  # the second is there, but nobody answers
        monkeypatch.setenv("DISPLAY", display)
        with pytest.raises(UsageError, match="'human' needs a display; use render_mode 'rgb_array'"):
            make(render_mode="human").reset(seed=0)


def test_a_window_is_shown_each_step_and_opened_anew_in_a_new_world(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    viewer = Mock()
    dress = Mock()  # slow, and nobody looks
    monkeypatch.setattr(picture, "dress", dress)
    monkeypatch.setattr(picture, "drawn", lambda _: Heightfield(np.zeros((9, 9)), 1.75))
    modules = {"mujoco.viewer": viewer, "glfw": viewer}
    monkeypatch.setattr(picture, "import_module", modules.__getitem__)
    env = make(render_mode="human")
    env.reset(seed=0)
    env.step(np.zeros(2, np.float32))
    env.reset()
    window = viewer.launch_passive.return_value
    assert dress.call_args.kwargs == {"quality": picture.QUALITY}
    assert (viewer.launch_passive.call_count, window.sync.call_count) == (1, 3)
    assert viewer.launch_passive.call_args.args[0].hfield_nrow.tolist() == [9]
    env.reset(seed=1)
    assert (viewer.launch_passive.call_count, window.close.call_count) == (2, 1)
    env.close()
    assert window.close.call_count == 2


def test_people_are_drawn_where_they_have_walked_to(
    make: Make, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("viser", reason="needs viser: pip install -e '.[live]'")
    (tmp_path / "yard.sdf").write_text(YARD)
    viewer, watch = Mock(), Watch()
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(picture, "dress", Mock())
    monkeypatch.setattr(picture, "import_module", lambda _: viewer)
    monkeypatch.setattr("harness.gym.live.LivePage", Mock(return_value=Mock(observers=(watch,))))
    for mode in ("human", "live"):
        env = make(render_mode=mode, terrain=str(tmp_path / "yard.sdf"), terrain_size=None)
        env.reset(seed=0)
        for _ in range(3):
            env.step(np.zeros(2, np.float32))
        drawn = viewer.launch_passive.call_args.args[1].mocap_pos if mode == "human" else watch.people
        x, y, z = env.driven.simulation.data.mocap_pos[0]
        assert drawn[0, :3] == pytest.approx([x, y, z])
        assert x == pytest.approx(0.2, abs=0.06)
