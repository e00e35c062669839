"""What a listener deserialises of each sample, field by field."""

import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from builtin_interfaces.msg import Time
from geometry_msgs.msg import (
    Point,
    Pose,
    PoseArray,
    PoseWithCovariance,
    Quaternion,
    Twist,
    TwistWithCovariance,
    Vector3,
)
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import (
    CameraInfo,
    FluidPressure,
    Image,
    Imu,
    JointState,
    LaserScan,
    MagneticField,
    NavSatFix,
    NavSatStatus,
    PointCloud2,
    PointField,
)
from std_msgs.msg import Bool, Float64MultiArray, Header, MultiArrayDimension, MultiArrayLayout

from harness import samples
from harness.robots import RoverSpec
from harness.ros.messages import by_names, filler, person
from harness.sensors import table
from harness.sensors.barometer import Pressure
from harness.sensors.camera.sensor import CameraState
from harness.sensors.choice import chosen
from harness.sensors.gnss import GnssFix
from harness.sensors.lidar_spec import LidarSpec
from harness.sensors.magnetometer import MagneticField as MagneticFieldSample
from harness.sensors.ranging import RangeReading
from tests.support.rovers import LEO, ROVER_ZERO4WD

STAMP_NS, STAMP = 12_000_000_345, Time(sec=12, nanosec=345)
LIDAR = LidarSpec(beams=5, range_min=0.25, range_max=8.0, angle_max=1.5)  # exact in float32
RANGES = np.array([0.5, np.inf, -np.inf, 1.25, 8.0], dtype=np.float32)
ATTITUDE = (0.1, 0.2, 0.3, 0.4)
HERE, LINEAR, ANGULAR = (1.0, -2.0, 3.0), (4.0, 5.0, 6.0), (7.0, 8.0, 9.0)
YAW = -2.0
TURNED = Quaternion(z=float(np.sin(YAW / 2)), w=float(np.cos(YAW / 2)))
SLIP = (0.1, 0.2, 0.3, 0.4)
LABEL = (
    "contact_force,rock_contact,scrape,speed,path_length,"
    "slip_front_left,slip_rear_left,slip_front_right,slip_rear_right,roughness"
)


def xyz(kind: type, values: tuple[float, ...]) -> Any:  # noqa: ANN401 - rclpy's classes have no types
    return kind(**dict(zip("xyzw", values, strict=False)))


def header(frame: str) -> Header:
    return Header(stamp=STAMP, frame_id=frame)


def planar(x: float, y: float) -> Pose:
    return Pose(position=Point(x=x, y=y, z=0.0), orientation=TURNED)


PIXELS = np.arange(216, dtype=np.uint8).reshape(8, 9, 3)
SEEN = CameraState(STAMP_NS, "camera", HERE, ATTITUDE, np.zeros(1))
COVARIANCE = tuple(float(n) for n in range(9))
SQUARE, SQRT3 = np.array([4.0, np.inf, -np.inf, 6.0], np.float32), 3.0**0.5
LAST = np.array([np.inf, 4.0, -np.inf, 6.0], np.float32)
FOCAL = 1.0 / np.tan(np.pi / 4)  # [pixels], of an image of two by two over 90 degrees


def float_field(name: str, offset: int) -> PointField:
    return PointField(name=name, offset=offset, datatype=PointField.FLOAT32, count=1)


EXPECTED: dict[str, tuple[samples.Sample, object]] = {
    "scan": (
        samples.LaserScan(STAMP_NS, RANGES),
        LaserScan(
            header=header("lidar_link"),
            angle_min=-1.5,
            angle_max=1.5,
            angle_increment=0.75,
            range_min=0.25,
            range_max=8.0,
            ranges=RANGES.tolist(),
            intensities=[0.0] * 5,
        ),
    ),
    "imu/data": (
        samples.Imu(STAMP_NS, ATTITUDE, ANGULAR, LINEAR),
        Imu(
            header=header("imu_link"),
            orientation=xyz(Quaternion, ATTITUDE),
            angular_velocity=xyz(Vector3, ANGULAR),
            linear_acceleration=xyz(Vector3, LINEAR),
        ),
    ),
    "rover/pose_array": (
        samples.Pose(STAMP_NS, HERE, ATTITUDE),
        PoseArray(
            header=header("world"),
            poses=[Pose(position=xyz(Point, HERE), orientation=xyz(Quaternion, ATTITUDE))],
        ),
    ),
    "odometry/wheels": (
        samples.Odometry(STAMP_NS, 1.0, 2.0, YAW, samples.Twist(0.5, 0.25)),
        Odometry(
            header=header("odom"),
            child_frame_id="base_link",
            pose=PoseWithCovariance(pose=planar(1.0, 2.0)),
            twist=TwistWithCovariance(twist=Twist(linear=Vector3(x=0.5), angular=Vector3(z=0.25))),
        ),
    ),
    "odom_ground_truth": (
        samples.GroundTruth(STAMP_NS, 1.0, 2.0, YAW, LINEAR, ANGULAR),
        Odometry(
            header=header("odom"),
            child_frame_id="base_footprint",
            pose=PoseWithCovariance(pose=planar(1.0, 2.0), covariance=np.diag([0.01] * 6).ravel()),
            twist=TwistWithCovariance(
                twist=Twist(linear=xyz(Vector3, LINEAR), angular=xyz(Vector3, ANGULAR))
            ),
        ),
    ),
    "joint_states": (
        samples.JointStates(STAMP_NS, HERE, LINEAR, ANGULAR),
        JointState(
            header=header(""),
            name=list(ROVER_ZERO4WD.joints),
            position=HERE,
            velocity=LINEAR,
            effort=ANGULAR,
        ),
    ),
    "rover/truth/contact": (
        samples.TruthState(STAMP_NS, True, False, False, 11.0, 12.0, 13.0, SLIP, 14.0),
        Bool(data=True),
    ),
    "rover/truth/traversal": (
        samples.TruthState(STAMP_NS, False, False, True, 11.0, 12.0, 13.0, SLIP, 14.0),
        Float64MultiArray(
            layout=MultiArrayLayout(dim=[MultiArrayDimension(label=LABEL, size=10, stride=10)]),
            data=[11.0, 0.0, 1.0, 12.0, 13.0, *SLIP, 14.0],
        ),
    ),
    "lidar2d/scan": (
        RangeReading(STAMP_NS, "lidar2d", RANGES, np.zeros(5, bool)),
        LaserScan(
            header=header("lidar2d_link"),
            angle_min=-0.5,
            angle_max=1.5,
            angle_increment=0.5,
            range_min=0.25,
            range_max=8.0,
            ranges=RANGES.tolist(),
        ),
    ),
    "lidar3d/points": (
        RangeReading(STAMP_NS, "lidar3d", LAST, np.array([False, False, True, True])),
        PointCloud2(
            header=header("lidar3d_link"),
            height=1,
            width=2,
            fields=[
                *(float_field(name, 4 * place) for place, name in enumerate("xyz")),
                float_field("intensity", 12),
                PointField(name="ring", offset=16, datatype=PointField.UINT16, count=1),
                float_field("time", 18),
            ],
            point_step=22,
            row_step=44,
            # Up by 30 degrees, ahead; then level, where there is an obstacle.
            data=struct.pack("<4fHf", 2 * SQRT3, 0.0, 2.0, 25.0, 1, 0.0)
            + struct.pack("<4fHf", 6.0, 0.0, 0.0, 50.0, 0, 0.0),
            is_dense=True,
        ),
    ),
    "depth/image": (
        RangeReading(STAMP_NS, "depth", SQUARE, np.zeros(4, bool)),
        Image(
            header=header("depth_link_optical"),
            height=2,
            width=2,
            encoding="32FC1",
            step=8,
            data=struct.pack("<4f", *SQUARE),
        ),
    ),
    "depth/camera_info": (
        RangeReading(STAMP_NS, "depth", SQUARE, np.zeros(4, bool)),
        CameraInfo(
            header=header("depth_link_optical"),
            height=2,
            width=2,
            distortion_model="plumb_bob",
            d=[0.0] * 5,
            k=np.array([FOCAL, 0.0, 0.5, 0.0, FOCAL, 0.5, 0.0, 0.0, 1.0]),
            r=np.eye(3).ravel(),
            p=np.array([FOCAL, 0.0, 0.5, 0.0, 0.0, FOCAL, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0]),
        ),
    ),
    "depth/points": (
        RangeReading(STAMP_NS, "depth", SQUARE, np.zeros(4, bool)),
        PointCloud2(
            header=header("depth_link_optical"),
            height=2,
            width=2,
            fields=[float_field(name, 4 * place) for place, name in enumerate("xyz")],
            point_step=12,
            row_step=24,
            # From the top left: each half a pixel from the axis.
            data=struct.pack("<3f", -2.0 / FOCAL, -2.0 / FOCAL, 4.0)
            + struct.pack("<6f", *[np.nan] * 6)
            + struct.pack("<3f", 3.0 / FOCAL, 3.0 / FOCAL, 6.0),
        ),
    ),
    "camera/image_raw": (
        SEEN,
        Image(
            header=header("camera_optical_frame"),
            height=8,
            width=9,
            encoding="rgb8",
            step=27,
            data=PIXELS.tobytes(),
        ),
    ),
    "camera/camera_info": (
        SEEN,
        CameraInfo(
            header=header("camera_optical_frame"),
            height=8,
            width=9,
            distortion_model="equidistant",
            d=[0.0] * 4,
            k=np.array([6.0, 0.0, 4.0, 0.0, 6.0, 3.5, 0.0, 0.0, 1.0]),
            r=np.eye(3).ravel(),
            p=np.array([6.0, 0.0, 4.0, 0.0, 0.0, 6.0, 3.5, 0.0, 0.0, 0.0, 1.0, 0.0]),
        ),
    ),
    "gnss/fix": (
        GnssFix(STAMP_NS, "gnss", 1.0, -2.0, 3.0, COVARIANCE, 1, 2),
        NavSatFix(
            header=header("gnss_link"),
            status=NavSatStatus(status=NavSatStatus.STATUS_GBAS_FIX, service=15),
            latitude=1.0,
            longitude=-2.0,
            altitude=3.0,
            position_covariance=np.array(COVARIANCE),
            position_covariance_type=NavSatFix.COVARIANCE_TYPE_APPROXIMATED,
        ),
    ),
    "magnetometer/mag": (
        MagneticFieldSample(STAMP_NS, "magnetometer", HERE, COVARIANCE),
        MagneticField(
            header=header("magnetometer_link"),
            magnetic_field=xyz(Vector3, HERE),
            magnetic_field_covariance=np.array(COVARIANCE),
        ),
    ),
    "barometer/pressure": (
        Pressure(STAMP_NS, "barometer", 1.5, 2.5),
        FluidPressure(header=header("barometer_link"), fluid_pressure=1.5, variance=2.5),
    ),
}
ROWS = chosen(
    ROVER_ZERO4WD.but(
        sensors=(
            {"kind": "lidar2d", "beams": 5, "angle_min": -0.5, "angle_max": 1.5}
            | {"range_min": 0.25, "range_max": 8.0},
            {"kind": "lidar3d", "elevations": [0.0, np.pi / 6], "columns": 2}
            | {"angle_min": -1.0, "angle_max": 0.0},
            {"kind": "depth", "width": 2, "height": 2, "fov": np.pi / 2, "cloud": True},
            {"kind": "camera", "lens": "fisheye", "width": 9, "height": 8, "fov": 1.5},
            {"kind": "gnss"},
            {"kind": "magnetometer"},
            {"kind": "barometer"},
            {"kind": "height_scan"},  # test_grid_map.py
        ),
    ),
    None,
)


def heard(topic_name: str, *sent: samples.Sample) -> list[Any]:
    """What a listener has of each sample, by way of one message that is refilled."""
    ((row, topic),) = ((row, topic) for row in ROWS for topic in row.topics if topic.name == topic_name)
    fill = filler(row, topic, ROVER_ZERO4WD, LIDAR, lambda _: PIXELS)
    messages = (fill(sample) for sample in sent)
    return [deserialize_message(serialize_message(message), type(message)) for message in messages]


@pytest.mark.parametrize("topic", EXPECTED)
def test_every_field_arrives_in_its_place_each_time(topic: str) -> None:
    sample, expected = EXPECTED[topic]
    earlier = replace(sample, stamp_ns=STAMP_NS - 10**9)
    assert heard(topic, earlier, sample)[-1] == expected


def test_the_pose_of_a_person_is_a_pose_without_a_stamp_each_time() -> None:
    people = samples.ActorPoses(STAMP_NS, (LINEAR, HERE), (ATTITUDE[::-1], ATTITUDE))
    fill = person(1)
    for expected in (people, replace(people, position=(LINEAR, ANGULAR))):
        message = fill(expected)
        back = deserialize_message(serialize_message(message), Pose)
        x, y, z = expected.position[1]
        assert (back.position.x, back.position.y, back.position.z) == (x, y, z)
        turn = back.orientation
        assert (turn.x, turn.y, turn.z, turn.w) == ATTITUDE


def test_every_topic_of_a_sensor_is_expected_here() -> None:
    assert {row.fault for row in ROWS} == {row.fault for row in table.SENSORS}
    told = [row for row in ROWS if row.sample is not samples.Transforms]  # test_frames.py
    assert list(EXPECTED) == [topic.name for row in told for topic in row.topics]


@pytest.mark.parametrize(
    ("rover", "imu_frame", "child", "joints"),
    [(LEO, "imu_frame", "base_footprint", 6), (ROVER_ZERO4WD, "imu_link", "base_link", 4)],
)
def test_frames_and_joints_are_those_of_the_rover(
    rover: RoverSpec, imu_frame: str, child: str, joints: int
) -> None:
    rows = [row for row in chosen(rover, ()) if row.sample is not samples.Transforms]
    fills = {topic.name: filler(row, topic, rover, LIDAR) for row in rows for topic in row.topics}
    told = {name: fills[name](sample) for name, (sample, _) in EXPECTED.items() if name in fills}
    assert told["imu/data"].header.frame_id == imu_frame
    assert told["odometry/wheels"].child_frame_id == child
    assert told["odom_ground_truth"].child_frame_id == "base_footprint"
    assert len(told["joint_states"].name) == joints


def test_the_clock_tells_the_time_of_a_tick() -> None:
    assert by_names(Clock(), samples.Tick)(samples.Tick(STAMP_NS, ())) == Clock(clock=STAMP)


@pytest.mark.parametrize("yaw", [3.0, np.inf, np.nan])
@pytest.mark.parametrize("topic", ["odometry/wheels", "odom_ground_truth"])
def test_a_yaw_is_a_turn_about_the_z_axis_and_a_faulty_one_is_no_number_and_stops_nobody(
    topic: str, yaw: float
) -> None:
    (message,) = heard(topic, replace(EXPECTED[topic][0], yaw=yaw))
    turn = message.pose.pose.orientation
    half = yaw / 2 if np.isfinite(yaw) else np.nan
    expected = [0.0, 0.0, np.sin(half), np.cos(half)]
    assert [turn.x, turn.y, turn.z, turn.w] == pytest.approx(expected, nan_ok=True)


def test_a_faulty_lidars_scan_has_the_beams_that_it_has_and_the_next_one_all() -> None:
    beams = [np.resize(RANGES, count) for count in (2, 0, 7, 5)]
    told = heard("scan", *(samples.LaserScan(STAMP_NS, ranges) for ranges in beams))
    assert [message.ranges.tolist() for message in told] == [ranges.tolist() for ranges in beams]


def test_a_pose_array_without_a_pose_is_empty_and_the_next_one_is_not() -> None:
    pose = samples.Pose(STAMP_NS, HERE, ATTITUDE)
    told = heard("rover/pose_array", replace(pose, empty=True), pose)
    assert [len(message.poses) for message in told] == [0, 1]
    assert told[0].header == header("world")


@pytest.mark.parametrize(
    ("told", "height", "dense", "kept"),
    [({"organised": True}, 2, False, 4), ({"misses": "nan"}, 1, False, 4), ({}, 1, True, 2)],
)
def test_a_lidars_misses_are_left_out_or_nan_and_a_cloud_may_be_an_image(
    told: dict[str, object], height: int, dense: bool, kept: int
) -> None:
    entry = {"kind": "lidar3d", "rings": 2, "columns": 2} | told
    row = chosen(ROVER_ZERO4WD.but(sensors=(entry,)), None)[-1]
    fill = filler(row, row.topics[0], ROVER_ZERO4WD, LIDAR)
    full = replace(EXPECTED["lidar3d/points"][0], ranges=np.full(4, 1.0, np.float32))
    assert (fill(full).height, fill(full).width, fill(full).is_dense) == (height, 4 // height, True)
    cloud = fill(EXPECTED["lidar3d/points"][0])
    assert (cloud.height, cloud.width, cloud.is_dense) == (height, kept // height, dense)
    points = np.frombuffer(cloud.data, "<f4,<f4,<f4,<f4,<u2,<f4")
    assert np.isnan(points["f0"]).tolist() == ([True, False, True, False] if kept == 4 else [False] * 2)
