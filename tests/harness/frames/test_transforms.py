"""The transforms of an episode, against MuJoCo's raw state at their tick."""

import math
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import mujoco
import pytest

from harness.episode.episode import Episode
from harness.frames.rover_frames import rover_frames
from harness.frames.transforms import TransformSensor, describe
from harness.frames.tree import Edge
from harness.samples import Odometry, Tick, Transforms, Twist
from harness.spec.ros import FrameOptions
from harness.spec.run import Run
from tests.harness.frames.made_rover import made_rover

PLANAR, WHOLE = FrameOptions(), FrameOptions(odom_tf_3d=True)
WHEELS, NONE = FrameOptions(odom_tf="wheels"), FrameOptions(odom_tf="none")


def drive(robot: str, options: FrameOptions | None) -> Iterator[tuple[Episode, Tick]]:
    """Ticks of half a second on rough ground, each with the state that it was read from."""
    episode = Episode(Run.of(robot=robot, lidar_beams=8), options)
    episode._drive.command(Twist(0.4, 1.0))
    for index in range(1, 51):
        episode.drive_wheels()
        episode.simulation.tick()
        episode.observe(index)
        yield episode, episode._ticks[-1]


def own(tick: Tick) -> list[Transforms]:
    return [sample for sample in tick.samples if isinstance(sample, Transforms)]


def edges(episode: Episode, sample: Transforms) -> dict[str, Edge]:
    """What a sample says, by the frame."""
    assert episode.description is not None
    told = {}
    for index in range(len(sample.translation) // 3):
        parent, child = episode.description.moving[index]
        xyz, xyzw = sample.translation[3 * index :][:3], sample.rotation[4 * index :][:4]
        told[child] = Edge(parent, child, xyz, xyzw)  # type: ignore[arg-type]  # of these lengths
    return told


@pytest.mark.parametrize("options", [PLANAR, WHOLE], ids=["planar", "3d"])
@pytest.mark.parametrize("robot", ["leo", "rover_zero4wd"])
def test_a_transform_goes_before_the_samples_of_each_tick_and_says_where_the_rover_is(
    robot: str, options: FrameOptions
) -> None:
    told = 0
    for episode, tick in drive(robot, options):
        if not tick.samples:
            continue
        first, *others = tick.samples
        assert isinstance(first, Transforms)
        assert others, "nothing to be transformed"
        assert {s.stamp_ns for s in tick.samples} == {tick.stamp_ns}
        (x, y, z, w, i, j, k) = episode.simulation.data.qpos[:7].tolist()
        base = edges(episode, first)[episode.simulation.scene.rover.odometry_child_frame]
        assert base.parent == "odom"
        if options.odom_tf_3d:
            assert (base.translation, base.rotation) == ((x, y, z), (i, j, k, w))
        else:
            yaw = math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))
            assert base.translation == (x, y, 0.0)
            assert base.rotation == pytest.approx((0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))
        told += 1
    assert told == 30, "50 Hz and 20 Hz fall on 60 ticks a second"


@pytest.mark.parametrize("robot", ["leo", "rover_zero4wd"])
def test_wheels_own_odom_as_the_odometry_has_it_and_goes_on_between_two_readings(robot: str) -> None:
    quiet = [tick.samples for _, tick in drive(robot, None)]
    poses, read = [], 0
    for (episode, tick), samples in zip(drive(robot, WHEELS), quiet, strict=True):
        assert repr(tick.samples[1:]) == repr(samples), "looking changes nothing"
        for sample in own(tick):
            base = edges(episode, sample)[episode.simulation.scene.rover.odometry_child_frame]
            poses.append(base.rotation[2])
        for odometry in tick.samples:
            if isinstance(odometry, Odometry):
                half = odometry.yaw / 2
                assert base.translation == (odometry.x, odometry.y, 0.0)
                assert base.rotation == (0.0, 0.0, math.sin(half), math.cos(half))
                read += 1
    assert read == {"leo": 10, "rover_zero4wd": 25}[robot]
    assert len(set(poses[-15:])) == 15, "a rover that turns does so between two readings too"


def test_joints_come_twenty_times_a_second_where_mujoco_has_their_frames() -> None:
    stamps = []
    for episode, tick in drive("leo", NONE):
        for sample in own(tick):
            stamps.append(sample.stamp_ns)
            model, data = episode.simulation.model, episode.simulation.data
            mujoco.mj_kinematics(model, data)
            told = edges(episode, sample)
            assert set(told) == {f"wheel_{w}_link" for w in ("FL", "RL", "FR", "RR")} | {
                "rocker_L_link",
                "rocker_R_link",
            }
            right, rear = told["rocker_R_link"], told["wheel_RR_link"]
            angle = data.joint("rocker_R_joint").qpos[0]
            half = (0.0, math.sin(angle / 2), 0.0, math.cos(angle / 2))
            assert right.rotation == pytest.approx(half, abs=1e-12)
            wheel = data.joint("wheel_RR_joint").qpos[0]
            half = (0.0, math.sin(wheel / 2), 0.0, math.cos(wheel / 2))
            assert rear.rotation == pytest.approx(half, abs=1e-12)
            left = data.joint("wheel_FL_joint").qpos[0]  # its frame is turned by pi: about -y
            half = (0.0, -math.sin(left / 2), 0.0, math.cos(left / 2))
            assert told["wheel_FL_link"].rotation == pytest.approx(half, abs=1e-9)
            assert right.translation == pytest.approx((0.00263, -0.14167, -0.04731))
    assert stamps == [50_000_000 * n for n in range(1, 11)]


def test_a_slide_moves_its_frame_along_its_axis_in_the_parent(tmp_path: Path) -> None:
    body = (
        '<body name="lift" pos="0.1 0 0.2" euler="90 0 0"><joint name="lift" type="slide" axis="0 0 1"/>'
        '<geom size="0.1"/></body>'
    )
    frames = rover_frames(made_rover(tmp_path, body))

    class Lifted:
        """A simulation of nothing but this model."""

        model, data = frames.model, frames.data
        time_ns = 50_000_000
        scene = SimpleNamespace(own=str)

    frames.data.joint("lift").qpos[0] = 0.3
    simulation: object = Lifted()
    sample = TransformSensor(simulation, frames, NONE, {}, 1).read()  # type: ignore[arg-type]
    assert sample.translation == pytest.approx((0.1, -0.3, 0.2))
    assert sample.rotation == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))


def test_the_description_names_what_moves_and_tells_what_does_not() -> None:
    frames = rover_frames(Episode(Run.of(terrain="flat", duration=0.01)).simulation.scene.rover)
    default = describe(frames, FrameOptions())
    assert default.moving[0] == ("odom", "base_footprint")
    assert default.owns_odom
    assert describe(frames, NONE).moving == default.moving[1:]
    assert not describe(frames, NONE).owns_odom
    mapped = describe(frames, FrameOptions(map_tf=True))
    assert mapped.fixed == (Edge("map", "odom", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)), *default.fixed)
    assert {child for _, child in default.moving} | {e.child for e in default.fixed} == {
        link.name for link in frames.links
    }
