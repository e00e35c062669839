"""A camera's options and frames, what is wrong with them, and what its sample says."""

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.robots import find_rover
from harness.sensors.camera.sensor import VISIBLE_STATE, CameraOptions, CameraSensor
from harness.sensors.choice import chosen
from tests.harness.sensors.installed import installation, simulation


@pytest.mark.parametrize(
    ("told", "message"),
    [
        ({"width": 20_000}, r"width 20000 of a camera is not valid; give 8 to 4096 pixels"),
        ({"height": 0}, r"height 0 of a camera is not valid; give 8 to 4096 pixels"),
        (
            {"fov": 0.0},
            r"fov 0 rad of a pinhole camera is not valid; give more than 0 and at most 2\.96",
        ),
        ({"fov": 3.0}, r"fov 3 rad of a pinhole camera is not valid"),
        ({"fov": 6.3, "lens": "fisheye"}, r"fov 6\.3 rad of a fisheye camera .* at most 6\.28"),
        ({"fov": float("nan")}, r"fov nan rad"),
        ({"lens": "mirror"}, r"lens 'mirror' does not exist; available: pinhole, fisheye"),
        ({"noise": 0.6}, r"noise 0\.6 of a camera is not valid; give 0 to 0\.5"),
        ({"rate": 30}, r"rate 30 Hz does not divide"),
    ],
)
def test_a_camera_that_makes_no_sense_is_refused(told: dict[str, object], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        CameraOptions(name="camera", **told).check()  # type: ignore[arg-type]  # of several types


@pytest.mark.parametrize("preset", CameraOptions.presets)
def test_every_preset_is_a_camera(preset: str) -> None:
    row = chosen(find_rover("leo"), (f"camera={preset}",))[-1]
    assert isinstance(row.given, CameraOptions)
    assert [topic.name for topic in row.topics] == ["camera/image_raw", "camera/camera_info"]
    size = {"roboterrain": (640, 480, 1.1), "fisheye": (1600, 600, 2.8)}.get(preset)
    assert size in (None, (row.given.width, row.given.height, row.given.fov))


@pytest.mark.parametrize(
    ("rover", "options", "frames"),
    [
        ("leo", {"name": "camera"}, []),  # it has one
        ("leo", {"name": "eye"}, [("camera_frame", "eye_link"), ("eye_link", "eye_optical_frame")]),
        ("rover_zero4wd", {"name": "camera"}, [("camera_link", "camera_optical_frame")]),
        (
            "rover_zero4wd",
            {"name": "eye", "parent": "base_link", "frame": "lens"},
            [("base_link", "eye_link"), ("eye_link", "lens")],
        ),
    ],
)
def test_it_hangs_where_the_rover_has_its_camera(
    rover: str, options: dict[str, str], frames: list[tuple[str, str]]
) -> None:
    rows = CameraOptions(**options).frames(find_rover(rover))  # type: ignore[arg-type]  # all are texts
    assert [(row.parent, row.child) for row in rows] == frames


def test_its_sample_is_the_scene_and_where_the_optical_frame_is() -> None:
    attitude, mounting = Rotation.from_quat((0.3, -0.4, 0.33, 0.8)), Rotation.from_euler("x", 0.4)
    rover = simulation((1.0, 2.0, 3.0), (0.8, 0.3, -0.4, 0.33))
    installed = installation(CameraOptions(name="eye"), xyz=(0.1, 0.2, 0.3), axes=mounting.as_matrix())
    state = CameraSensor(rover, installed, 10).read()
    assert (state.sensor, state.stamp_ns) == ("eye", 0)
    assert state.position == pytest.approx(np.add((1.0, 2.0, 3.0), attitude.apply((0.1, 0.2, 0.3))))
    turn = Rotation.from_quat(state.orientation).inv() * attitude * mounting
    assert turn.magnitude() == pytest.approx(0.0, abs=1e-9)
    kinds = mujoco.mjtState
    assert kinds.mjSTATE_QPOS | kinds.mjSTATE_MOCAP_POS | kinds.mjSTATE_MOCAP_QUAT == VISIBLE_STATE
    np.testing.assert_array_equal(state.state, rover.data.qpos)
