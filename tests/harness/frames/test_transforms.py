"""The transforms of an episode, against MuJoCo's raw state at their tick."""

import math
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.episode.episode import Episode
from harness.frames.rover_frames import RoverFrames, rover_frames
from harness.frames.transforms import TransformSensor, describe
from harness.frames.tree import Edge
from harness.robots import ROVERS
from harness.samples import Odometry, Tick, Transforms
from harness.spec.ros import ODOM_SOURCES, FrameOptions
from harness.spec.run import Run
from tests.harness.conftest import MakeSimulation
from tests.harness.frames.made_rover import made_rover
from tests.support.rovers import LEO

PLANAR, WHOLE = FrameOptions(), FrameOptions(odom_tf_3d=True)
WHEELS, NONE = FrameOptions(odom_tf="wheels"), FrameOptions(odom_tf="none")


def drive(robot: str, options: FrameOptions) -> Iterator[tuple[Episode, Tick]]:
    """Ticks of half a second on rough ground, each with the state that it was read from."""
    run = Run.of(robot=robot, lidar_beams=8, duration=0.5, driver="cmd_vel", commands=[(0.0, 0.4, 1.0)])
    episode = Episode(run, frame_options=options)
    for index in range(1, 51):
        if index % 5 == 1:
            episode.begin_period(index - 1)
        episode.pilot.drive_wheels(1)
        episode.simulation.physics.run()
        assert list(episode.simulation.physics.shown()) == [0]
        episode.observe(index)
        yield episode, episode.end_period(is_last=False).ticks[0]


def poses(episode: Episode, sample: Transforms) -> dict[tuple[str, str], NDArray[np.float64]]:
    """What a sample says: position and rotation matrix by parent and child."""
    assert episode.description is not None
    moving = episode.description.moving
    xyz, xyzw = (np.array(each) for each in (sample.translation, sample.rotation))
    turns = Rotation.from_quat(xyzw.reshape(-1, 4)).as_matrix()
    rows = zip(moving, xyz.reshape(-1, 3), turns, strict=False)
    return {names: np.column_stack([turn, place]) for names, place, turn in rows}


def in_world(
    frames: RoverFrames, name: str, data: mujoco.MjData, scene: mujoco.MjModel
) -> NDArray[np.float64]:
    """The pose of a frame: it moves with its body as it lies in it at rest."""
    (link,) = (link for link in frames.links if link.name == name)
    body = scene.body(frames.model.body(link.body).name).id
    now, rest = np.eye(4), np.eye(4)
    now[:3] = np.column_stack([data.xmat[body].reshape(3, 3), data.xpos[body]])
    rest[:3] = np.column_stack([frames.data.xmat[link.body].reshape(3, 3), frames.data.xpos[link.body]])
    pose: NDArray[np.float64] = now @ np.linalg.inv(rest) @ link.in_base
    return pose


@pytest.mark.parametrize(("robot", "options"), [("leo", PLANAR), ("rover_zero4wd", WHOLE)])
def test_a_transform_goes_before_the_samples_of_a_tick_and_says_where_frames_are(
    robot: str, options: FrameOptions
) -> None:
    ticks = joints = 0
    frames = rover_frames(ROVERS[robot])
    for episode, tick in drive(robot, options):
        own = tick.of(Transforms)
        if own is None:
            continue
        assert (tick.samples[0], own.stamp_ns) == (own, tick.stamp_ns)
        ticks += 1
        scene = episode.simulation.scene
        model, data, base = scene.model, episode.simulation.data, scene.rover.odometry_child_frame
        read = poses(episode, own)
        x, y, z, *turn = data.qpos[:7]
        expected = Rotation.from_quat(turn, scalar_first=True)
        if options is PLANAR:
            front, z = expected.apply([1.0, 0.0, 0.0]), 0.0
            expected = Rotation.from_euler("z", math.atan2(front[1], front[0]))
        pose = np.column_stack([expected.as_matrix(), (x, y, z)])
        assert read.pop(("odom", base)) == pytest.approx(pose)
        if read:
            mujoco.mj_kinematics(model, data)
            joints += 1
            assert {child for _, child in read} == {link.name for link in frames.moving}
        for (parent, child), told in read.items():
            there = (in_world(frames, name, data, model) for name in (parent, child))
            expected_pose = np.linalg.inv(next(there)) @ next(there)
            assert told == pytest.approx(expected_pose[:3], abs=1e-9)
    assert (joints, ticks) == (10, 30), "20 Hz; 50 Hz and 20 Hz fall on 60 ticks a second"


def test_the_transform_of_odometry_turns_between_two_readings_too() -> None:
    yaws = []
    for episode, tick in drive("leo", WHEELS):
        own, odometry = tick.of(Transforms), tick.of(Odometry)
        if own is not None:
            read = poses(episode, own)["odom", "base_footprint"]
            yaws.append(Rotation.from_matrix(read[:, :3]).as_euler("xyz")[2])
        if odometry is not None:
            assert (*read[:, 3], yaws[-1]) == pytest.approx((odometry.x, odometry.y, 0.0, odometry.yaw))
    assert len(set(yaws[-15:])) == 15


@pytest.mark.parametrize("robot", ROVERS)
def test_a_mount_goes_with_its_body_however_that_is_turned(
    robot: str, make_simulation: MakeSimulation
) -> None:
    simulation, rng = make_simulation(robot), np.random.default_rng(0)
    model, data, frames = simulation.model, simulation.data, rover_frames(ROVERS[robot])
    data.qpos[:] = rng.normal(size=model.nq)
    data.qpos[3:7] /= np.linalg.norm(data.qpos[3:7])
    mujoco.mj_kinematics(model, data)
    for link in frames.links:
        pose = in_world(frames, link.name, data, model)
        expected = np.vstack([pose[:3, 3], pose[:3, :3]])
        assert frames.mount(link.name, model).pose(data) == pytest.approx(expected, abs=1e-9)


def test_a_slide_moves_its_frame_along_its_axis_in_the_parent(tmp_path: Path) -> None:
    body = (
        '<body name="lift" pos="0.1 0 0.2" euler="90 0 0"><joint name="lift" type="slide" axis="0 0 1"/>'
        '<geom size="0.1"/></body>'
    )
    frames = rover_frames(made_rover(tmp_path, body))
    frames.data.joint("lift").qpos[0] = 0.3
    simulation: object = SimpleNamespace(
        model=frames.model, data=frames.data, time_ns=50_000_000, scene=SimpleNamespace(own=str)
    )
    sample = TransformSensor(simulation, frames, NONE, {}, 1).read()  # type: ignore[arg-type]
    assert sample.translation == pytest.approx((0.1, -0.3, 0.2))
    assert sample.rotation == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))


@pytest.mark.parametrize("map_tf", [False, True])
@pytest.mark.parametrize("odom_tf", ODOM_SOURCES)
def test_the_description_names_what_moves_and_holds_what_does_not(odom_tf: str, map_tf: bool) -> None:
    frames, owns = rover_frames(LEO), odom_tf != "none"
    told = describe(frames, FrameOptions.model_validate({"odom_tf": odom_tf, "map_tf": map_tf}))
    assert (told.moving[0] == ("odom", "base_footprint"), told.owns_odom) == (owns, owns)
    to_odom = Edge("map", "odom", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    assert [edge for edge in told.fixed if "odom" in (edge.parent, edge.child)] == [to_odom] * map_tf
    children = {child for _, child in told.moving} | {edge.child for edge in told.fixed} - {"odom"}
    assert children == {link.name for link in frames.links[1 - owns :]}


def test_the_frame_of_the_true_odometry_is_there_on_every_rover_and_hangs_on_the_base() -> None:
    """Its pose in odom is what /odom_ground_truth says: that of the model frame, from above."""
    for rover in ROVERS.values():
        frames = rover_frames(rover)
        description = describe(frames, FrameOptions())
        parents = {edge.child: edge for edge in description.fixed} | dict.fromkeys(
            child for _, child in description.moving
        )
        edge = parents["base_footprint"]
        assert edge == (None if frames.base == "base_footprint" else Edge(frames.base, "base_footprint"))
