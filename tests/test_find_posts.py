"""examples/find_posts.py finds the posts in our images within 3 m, and none that is not there."""

import math
import runpy
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.episode.assembly import scenery, sensor_rows
from harness.episode.episode import Episode
from harness.physics.opengl import gl_context
from harness.sensors.camera.renderer import CameraRenderer
from harness.sensors.camera.sensor import CameraOptions, CameraState
from harness.spec.run import Run

pytest.importorskip("cv2", reason="OpenCV is not installed: pip install opencv-python-headless")
pytest.importorskip("rclpy", reason="ROS 2 is not installed")

NODE = runpy.run_path(str(Path(__file__).parents[1] / "examples" / "find_posts.py"))
DEGREES = 60.0  # between a face's normal and the view: what is seen flatter is not asked for
NEAREST, FARTHEST, MARGIN = 0.5, 3.0, 4  # [m], [m], [pixels]
Points = NDArray[np.float64]


def posts(seed: int) -> list[str]:
    """Twelve posts around the start, 1.2 to 2.9 m away, turned at random."""
    rng, texts = np.random.default_rng(seed), []
    for number, angle in enumerate(np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)):
        distance, yaw, height = rng.uniform((1.4, -3.1, 0.5), (2.9, 3.1, 0.8))
        x, y = distance * np.cos(angle), distance * np.sin(angle)
        texts.append(f"aruco:x={x:.3f},y={y:.3f},yaw={yaw:.3f},id={number},height={height:.2f}")
    return texts


def seen(run: Run, states: list[CameraState]) -> list[tuple[set[int], set[int], set[int]]]:
    """Of each image the markers that must be found, those that are found, and those that may be."""
    (camera,) = (r.given for r in sensor_rows(run.rover) if isinstance(r.given, CameraOptions))
    world, fleet = scenery(run)
    try:
        context = gl_context("a test", 1, 1)
    except UsageError as error:
        pytest.skip(str(error))
    detector, counts = NODE["detector"]("4x4_50"), []
    with CameraRenderer(world, fleet, {camera.name: camera}, context, run.seed) as renderer:
        for state in states:
            found = {number for number, _ in NODE["find"](renderer.image(camera.name, state), detector)}
            faces = [(t.spec.options.id, skin.vertices) for t in world.targets for skin in t.skins]
            must = {number for number, face in faces if is_plain(state, camera, face)}
            counts.append(
                (must, found, {number for number, face in faces if in_view(state, camera, face)})
            )
    return counts


def pixels(state: CameraState, camera: CameraOptions, points: Points) -> tuple[Points, Points]:
    """Where points of the world [m] are in the image, and how far ahead [m]."""
    local = Rotation.from_quat(state.orientation).inv().apply(points - np.array(state.position))
    focal = camera.width / 2 / np.tan(camera.fov / 2)
    middle = np.array([camera.width, camera.height]) / 2
    return local[:, :2] / np.maximum(local[:, 2:], 1e-6) * focal + middle, local[:, 2]


def in_view(state: CameraState, camera: CameraOptions, face: Points) -> bool:
    at, ahead = pixels(state, camera, face)
    size = np.array([camera.width, camera.height])
    return bool((ahead > 0.0).any() and ((at > -50) & (at < size + 50)).all(axis=1).any())


def is_plain(state: CameraState, camera: CameraOptions, face: Points) -> bool:
    """Whether all of a face is in the image, near and turned to the camera enough."""
    at, ahead = pixels(state, camera, face)
    size = np.array([camera.width, camera.height])
    inside = (ahead > 0.0).all() and ((at > MARGIN) & (at < size - MARGIN)).all()
    away = np.array(state.position) - face.mean(axis=0)
    normal = np.cross(face[1] - face[0], face[3] - face[0])
    cos = float(away @ normal / np.linalg.norm(away) / np.linalg.norm(normal))
    near = NEAREST <= float(np.linalg.norm(away)) <= FARTHEST
    return bool(inside and near and cos >= np.cos(np.radians(DEGREES)))


def test_posts_within_3_m_are_found_and_none_that_is_not_there() -> None:
    must = hits = ghosts = 0
    run = Run.of(
        terrain="rocky", seed=1, robot="rover_zero4wd", driver="spin", sensors="camera",
        targets=posts(1), duration=8.0,
    )  # fmt: skip
    batches = Episode(run).batches()
    samples = (sample for batch in batches for tick in batch.ticks for sample in tick.samples)
    states = [sample for sample in samples if isinstance(sample, CameraState)]
    for expected, found, possible in seen(run, states[::4]):
        must, hits = must + len(expected), hits + len(expected & found)
        ghosts += len(found - possible)
    assert must >= 30
    assert hits >= 0.95 * must, f"{hits} of {must}"
    assert ghosts == 0


def test_the_node_tells_where_a_post_is(ros_domain: int) -> None:
    """The post is 2.4 m ahead and 0.3 m to the left, the camera 0.2 m ahead of the rover's middle."""
    from geometry_msgs.msg import PoseStamped  # noqa: PLC0415 - with ROS alone

    from harness.testing import Trial  # noqa: PLC0415

    del ros_domain
    run = Run.of(
        terrain="flat",
        robot="rover_zero4wd",
        driver="cmd_vel",
        sensors="camera",
        targets=["aruco:x=2.4,y=0.3,id=3,height=0.5"],
        duration=3.0,
    )
    with Trial(run) as trial:
        trial.host(NODE["FindPosts"])
        found = trial.collect(PoseStamped, "marker_3")
        trial.until(lambda: len(found) > 0, within=2.5)
        at = found.messages[-1].pose.position
        assert found.messages[-1].header.frame_id == "camera_optical_frame"
        assert math.hypot(at.x, at.z) == pytest.approx(math.hypot(2.4 - 0.2, 0.3) - 0.058, abs=0.06)
        assert at.x == pytest.approx(-0.3, abs=0.05)  # to the left
