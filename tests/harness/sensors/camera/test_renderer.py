"""Drawn images against geometry: each pixel sees the ball where the formula of its lens says so."""

from collections.abc import Iterator

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.physics.opengl import gl_context
from harness.physics.scene import build_scenes
from harness.sensors.camera.renderer import CameraRenderer
from harness.sensors.camera.sensor import VISIBLE_STATE, CameraState
from tests.harness.sensors.camera.staged import BALL, CAMERAS, EYE, RADIUS, looking, scenery

# Yaw and pitch [rad]; of the fisheye, the ball is on the seam of two faces of its cube, and on one.
VIEWS = [
    ("pinhole", -0.15, -0.1),
    ("fisheye", -0.1, 0.0),
    ("fisheye", 0.9, -0.1),
]


@pytest.fixture(scope="module")
def renderer() -> Iterator[CameraRenderer]:
    try:
        context = gl_context("a test", 16, 16)
    except UsageError as error:
        pytest.skip(str(error))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("harness.physics.stage.SOIL_PIXELS", 128)  # the soil's grain takes a second
        with CameraRenderer(*scenery(), CAMERAS, context, seed=3) as renderer:
            yield renderer


def state(camera: str, yaw: float = 0.0, pitch: float = 0.0, stamp_ns: int = 0) -> CameraState:
    model = build_scenes(*scenery(), 0.002)[0].model
    data, visible = mujoco.MjData(model), np.empty(mujoco.mj_stateSize(model, VISIBLE_STATE))
    data.qpos[:3] = (-2.0, 0.0, 0.0)  # out of the way
    mujoco.mj_getState(model, data, visible, VISIBLE_STATE)
    return CameraState(stamp_ns, camera, EYE, looking(yaw, pitch), visible)


def sees_ball(camera: str, yaw: float, pitch: float) -> NDArray[np.bool_]:
    """Which pixels see it: the distance of their ray from its middle is less than its radius."""
    options = CAMERAS[camera]
    rows, columns = np.indices((options.height, options.width), dtype=float)
    x, y = columns - (options.width - 1) / 2, rows - (options.height - 1) / 2
    if options.lens == "pinhole":
        ahead = np.stack([x, y, np.full_like(x, options.width / 2 / np.tan(options.fov / 2))], axis=-1)
    else:
        theta, around = np.hypot(x, y) * options.fov / options.width, np.arctan2(y, x)
        level = np.sin(theta)
        ahead = np.stack([level * np.cos(around), level * np.sin(around), np.cos(theta)], axis=-1)
    rays = Rotation.from_quat(looking(yaw, pitch)).apply(ahead.reshape(-1, 3)).reshape(ahead.shape)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    to_ball = np.subtract(BALL, EYE)
    along = rays @ to_ball
    return np.asarray((along > 0) & (to_ball @ to_ball - along**2 < RADIUS**2))


@pytest.mark.parametrize(("camera", "yaw", "pitch"), VIEWS)
def test_the_ball_is_where_the_lens_puts_it(
    renderer: CameraRenderer, camera: str, yaw: float, pitch: float
) -> None:
    image = renderer.image(camera, state(camera, yaw, pitch)).astype(int)
    expected = sees_ball(camera, yaw, pitch)
    found = (image.sum(axis=-1) < 420) & maximum_filter(expected, 7)  # the sky behind it is bright
    assert expected.sum() > 80
    for axis in (0, 1):
        told, wanted = (np.nonzero(mask)[axis].mean() for mask in (found, expected))
        assert told == pytest.approx(wanted, abs=0.15)
    assert (found ^ expected).sum() < 0.06 * expected.sum()  # pixels on its rim see both


@pytest.mark.parametrize(("camera", "stamp_ns"), [("noisy", 1), ("noisy_too", 0)])
def test_noise_has_its_deviation_and_is_another_for_each_stamp_and_camera(
    renderer: CameraRenderer, camera: str, stamp_ns: int
) -> None:
    clean = renderer.image("pinhole", state("pinhole")).astype(float)
    which = (("noisy", 0), (camera, stamp_ns))
    errors = [renderer.image(name, state(name, stamp_ns=n)) - clean for name, n in which]
    for error in errors:
        assert error.std() == pytest.approx(0.02 * 255, rel=0.02)
        assert error.mean() == pytest.approx(0.0, abs=0.15)
    assert abs(np.corrcoef(errors[0].ravel(), errors[1].ravel())[0, 1]) < 0.03
