"""What a listener deserialises of samples that no healthy drive has, and of cameras, field by field.

What a healthy drive says in every field is held to raw simulator states by the oracle for topics
(tests/e2e/test_topic_oracle.py).
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Pose
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CameraInfo, Image, NavSatFix

from harness import samples
from harness.base.message_types import GRID_MAP, typestore
from harness.episode.assembly import sensor_rows
from harness.episode.topics import painter
from harness.messages.blank import blank, cdr
from harness.messages.fillers import filler, person
from harness.messages.optional import Draw, grid_map_fill, image_fill, lens_info
from harness.robots.lidar import LidarSpec
from harness.ros.channel import open_channel
from harness.ros.foreign_type import message_type
from harness.sensors.camera.sensor import CameraOptions, CameraState
from harness.sensors.choice import chosen
from harness.sensors.gnss import GnssFix
from harness.sensors.height_scan import HeightScan, HeightScanOptions
from harness.sensors.ranging import RangeReading
from harness.sensors.table import Topic
from harness.spec.rover import RoverSetup
from harness.spec.run import Run
from tests.support.ros import Ros
from tests.support.rovers import ROVER_ZERO4WD

STAMP_NS, STAMP = 12_000_000_345, Time(sec=12, nanosec=345)
HERE, THERE = (1.0, -2.0, 3.0), (4.0, 5.0, 6.0)
ATTITUDE = (0.1, 0.2, 0.3, 0.4)
RANGES = np.array([0.5, np.inf, -np.inf, 1.25, 8.0], dtype=np.float32)
EYE = CameraOptions(name="eye", width=9, height=8, fov=1.0)
SEEN = CameraState(STAMP_NS, "eye", HERE, ATTITUDE, np.zeros(1))
PIXELS = np.arange(216, dtype=np.uint8).reshape(8, 9, 3)


def rows(*sensors: dict[str, object]) -> Any:  # noqa: ANN401 - of the table
    return chosen(ROVER_ZERO4WD.but(sensors=sensors), None)


def heard(
    topic_name: str,
    *sent: samples.Sample,
    sensors: Any = (),  # noqa: ANN401
    setup: RoverSetup | None = None,
) -> list[Any]:
    """What a listener has of each sample, by way of one message that is refilled."""
    carried = rows(*sensors) if setup is None else sensor_rows(setup)
    every = ((row, topic) for row in carried for topic in row.topics)
    ((row, topic),) = (each for each in every if each[1].name == topic_name)
    fill = filler(row, topic, ROVER_ZERO4WD, LidarSpec(beams=5), lambda _: PIXELS)
    kind = message_type(topic.message_type)
    messages = [deserialize_message(fill(sample), kind) for sample in sent]
    assert messages[0].header.stamp == STAMP
    return messages


@pytest.mark.parametrize("yaw", [3.0, np.inf, np.nan])
@pytest.mark.parametrize(
    ("topic", "sample"),
    [
        ("odometry/wheels", samples.Odometry(STAMP_NS, 1.0, 2.0, 0.0, samples.Twist(0.5, 0.25))),
        ("odom_ground_truth", samples.GroundTruth(STAMP_NS, 1.0, 2.0, 0.0, HERE, THERE)),
    ],
)
def test_a_yaw_is_a_turn_about_the_z_axis_and_a_faulty_one_is_no_number_and_stops_nobody(
    topic: str, sample: samples.Odometry | samples.GroundTruth, yaw: float
) -> None:
    (message,) = heard(topic, replace(sample, yaw=yaw))
    turn = message.pose.pose.orientation
    half = yaw / 2 if np.isfinite(yaw) else np.nan
    expected = [0.0, 0.0, np.sin(half), np.cos(half)]
    assert [turn.x, turn.y, turn.z, turn.w] == pytest.approx(expected, nan_ok=True)


def test_what_noise_leaves_uncertain_is_told_and_of_exact_readings_nothing() -> None:
    """Zeros mean unknown; an integrated pose says by a first -1 that it has no estimate."""
    imu = samples.Imu(STAMP_NS, ATTITUDE, HERE, THERE)
    odometry = samples.Odometry(STAMP_NS, 1.0, 2.0, 0.0, samples.Twist(0.5, 0.25))
    parts = ("orientation", "angular_velocity", "linear_acceleration")
    for noise, (attitude, rate, force), twist in (
        ("hardware", (0.02, 5 / 3 * np.pi / 180, 0.02 * 9.80665), (1e-4, 1e-3)),
        ("white", (0.0, 0.001, 0.032), (0.0, 0.0)),
        (None, (0.0, 0.0, 0.0), (0.0, 0.0)),
    ):
        sensed, rolled = (
            heard(topic, sample, setup=RoverSetup(robot="rover_zero4wd", noise=noise))[0]
            for topic, sample in (("imu/data", imu), ("odometry/wheels", odometry))
        )
        told = [getattr(sensed, f"{part}_covariance").reshape(3, 3) for part in parts]
        for matrix, deviation in zip(told, (attitude, rate, force), strict=True):
            assert matrix == pytest.approx(np.eye(3) * matrix[0, 0])
            assert deviation**2 <= matrix[0, 0] <= 1.2 * deviation**2
        covariance = rolled.twist.covariance.reshape(6, 6)
        assert (covariance[0, 0], covariance[5, 5]) == twist
        assert rolled.pose.covariance.tolist() == [-1.0 if noise == "hardware" else 0.0, *[0.0] * 35]


def test_what_a_fault_has_emptied_or_cut_is_so_and_the_next_message_is_whole() -> None:
    beams = [np.resize(RANGES, count) for count in (2, 0, 7, 5)]
    told = heard("scan", *(samples.LaserScan(STAMP_NS, ranges) for ranges in beams))
    assert [message.ranges.tolist() for message in told] == [ranges.tolist() for ranges in beams]
    pose = samples.Pose(STAMP_NS, HERE, ATTITUDE)
    told = heard("rover/pose_array", replace(pose, empty=True), pose)
    assert [len(message.poses) for message in told] == [0, 1]
    assert told[0].header.frame_id == "world"


def test_the_pose_of_a_person_is_a_pose_without_a_stamp_each_time() -> None:
    people = samples.ActorPoses(STAMP_NS, (THERE, HERE), (ATTITUDE[::-1], ATTITUDE))
    fill = person(1)
    for expected in (people, replace(people, position=(HERE, THERE))):
        back = deserialize_message(fill(expected), Pose)
        assert (back.position.x, back.position.y, back.position.z) == expected.position[1]
        turn = back.orientation
        assert (turn.x, turn.y, turn.z, turn.w) == ATTITUDE


def test_a_fix_has_its_covariance_and_what_kind_of_fix_it_is() -> None:
    covariance = np.arange(9.0)
    fix = GnssFix(STAMP_NS, "gnss", 1.0, -2.0, 3.0, tuple(covariance), 1, 2)
    (told,) = heard("gnss/fix", fix, sensors=[{"kind": "gnss"}])
    assert told.position_covariance.tolist() == covariance.tolist()
    kinds = (told.status.status, told.position_covariance_type)
    assert kinds == (fix.fix, NavSatFix.COVARIANCE_TYPE_APPROXIMATED)


@pytest.mark.parametrize(
    ("told", "height", "dense", "kept"),
    [({"organised": True}, 2, False, 4), ({"misses": "nan"}, 1, False, 4), ({}, 1, True, 2)],
)
def test_a_lidars_misses_are_left_out_or_nan_and_a_cloud_may_be_an_image(
    told: dict[str, object], height: int, dense: bool, kept: int
) -> None:
    sensor = {"kind": "lidar3d", "rings": 2, "columns": 2} | told
    ranges = np.array([np.inf, 4.0, -np.inf, 6.0], np.float32)
    reading = RangeReading(STAMP_NS, "lidar3d", ranges, np.array([False, False, True, True]))
    whole = replace(reading, ranges=np.ones(4, np.float32))
    full, cloud = heard("lidar3d/points", whole, reading, sensors=[sensor])
    assert (full.height, full.width, full.is_dense) == (height, 4 // height, True)
    assert (cloud.height, cloud.width, cloud.is_dense) == (height, kept // height, dense)
    points = np.frombuffer(cloud.data, "<f4,<f4,<f4,<f4,<u2,<f4")
    assert np.isnan(points["f0"]).tolist() == ([True, False, True, False] if kept == 4 else [False] * 2)


def test_every_cell_of_a_grid_map_is_where_grid_map_looks_for_it_and_its_axes_turn() -> None:
    """grid_map: index (0, 0) is at the largest x and y; data column by column (column-major)."""
    options = HeightScanOptions(name="scan", size=(0.6, 0.4), resolution=0.2)  # 3 x 2 cells
    heights = np.array([[0.0, 1.0], [2.0, 3.0], [np.nan, 5.0]], np.float32)  # from the lowest x and y
    scan = HeightScan(STAMP_NS, "scan", heights, x=10.0, y=20.0, z=0.5, yaw=np.pi / 2)
    told: Any = typestore().deserialize_cdr(grid_map_fill(options)(scan), GRID_MAP)
    turn = told.info.pose.orientation
    assert (turn.x, turn.y, turn.z, turn.w) == pytest.approx((0.0, 0.0, 0.5**0.5, 0.5**0.5))
    for row, x in enumerate((2, 1, 0)):
        for column, y in enumerate((1, 0)):
            value = told.data[0].data[column * 3 + row]
            np.testing.assert_equal(value, heights[x, y] + np.float32(0.5))


@pytest.mark.parametrize(
    ("lens", "model", "focal"),
    [("pinhole", "plumb_bob", 4.5 / np.tan(0.5)), ("fisheye", "equidistant", 9)],
)
def test_camera_info_is_the_lens(lens: str, model: str, focal: float) -> None:
    data = lens_info(blank("sensor_msgs/msg/CameraInfo"), EYE.but(lens=lens).lens_of())(SEEN)
    told = deserialize_message(data, CameraInfo)
    assert (told.header.stamp, told.height, told.width) == (STAMP, 8, 9)
    assert told.distortion_model == model
    assert told.d.tolist() == [0.0] * {"plumb_bob": 5, "equidistant": 4}[model]
    k = np.array([[focal, 0, 4], [0, focal, 3.5], [0, 0, 1]])
    assert told.k.reshape(3, 3) == pytest.approx(k)
    assert told.p.reshape(3, 4) == pytest.approx(np.hstack([k, np.zeros((3, 1))]))
    assert told.r.tolist() == np.eye(3).ravel().tolist()


def test_an_image_is_what_was_drawn_row_by_row() -> None:
    sensor = {"kind": "camera", "name": "eye", "width": 9, "height": 8}
    (told,) = heard("eye/image_raw", SEEN, sensors=[sensor])
    assert (told.header.frame_id, told.height, told.width, told.step) == ("eye_optical_frame", 8, 9, 27)
    assert (told.encoding, told.is_bigendian, bytes(told.data)) == ("rgb8", 0, bytes(range(216)))


@pytest.mark.parametrize(
    ("listens", "records", "draw", "sent"),
    [
        (False, False, lambda _: PIXELS, 0),
        (True, False, lambda _: PIXELS, 2),
        (False, True, lambda _: PIXELS, 2),
        (True, True, lambda _: None, 0),
        (True, True, None, 0),
    ],
)
def test_an_image_is_drawn_and_sent_while_somebody_wants_it(
    ros: Ros, listens: bool, records: bool, draw: Draw | None, sent: int
) -> None:
    topic = Topic("image", "sensor_msgs/msg/Image", on_demand=True)
    channel = open_channel(
        ros.node("camera"), topic, image_fill(blank("sensor_msgs/msg/Image"), EYE, draw)
    )
    if listens:
        ros.node("viewer").create_subscription(Image, "image", lambda _: None, 1)
        ros.until(channel.publisher.get_subscription_count)
    if records:
        channel.record, channel.is_wanted = bytes, lambda: True
    for _ in range(2):
        channel.publish(SEEN)
    assert channel.published == sent


def test_what_nobody_gets_is_counted_but_not_made_unless_it_is_latched(ros: Ros) -> None:
    made: list[object] = []
    topics = [
        Topic(name, "sensor_msgs/msg/Image", latched=name == "latched") for name in ("a", "latched")
    ]
    volatile, latched = (open_channel(ros.node(t.name), t, _noting(made)) for t in topics)
    for channel in (volatile, latched, volatile):
        channel.publish(channel)
    assert (volatile.published, latched.published, made) == (2, 1, [latched])
    heard: list[Image] = []
    ros.node("viewer").create_subscription(Image, "a", heard.append, 1)
    ros.until(volatile.publisher.get_subscription_count)
    volatile.publish(volatile)
    ros.until(lambda: heard)
    assert (volatile.published, made) == (3, [latched, volatile])


def _noting(made: list[object]) -> Callable[[object], bytes]:
    def fill(sample: object) -> bytes:
        made.append(sample)
        return cdr(blank("sensor_msgs/msg/Image"))

    return fill


def test_a_run_has_a_painter_of_its_cameras_alone() -> None:
    run = Run.of(sensors=("camera=small", "gnss"), seed=4)
    subject = painter(run, 0, print)
    assert [camera.width for camera in subject._cameras.values()] == [160]
    assert subject._seed == 4
    there, eye = (2.0, 1.0, 0.5), ["camera=fisheye"]
    other = RoverSetup(robot="rover_zero4wd", name="b", start=there).but(sensors=eye)
    second = painter(run.but(rovers=(run.rover, other)), 1, print)
    assert [camera.width for camera in second._cameras.values()] == [1600]
    assert second._seed != 4
