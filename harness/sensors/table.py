"""The sensors: one row each. Episode, bridge, metrics, faults and recorder read this table.

A new sensor is a sample and a Sensor that reads it (one file), its row here, and a test of its values.
Importing the table loads neither MuJoCo nor compiled kernels, so that --help is there at once. A row
with `options` is of a kind of sensor that is only made when asked for; harness.sensors.choice makes of
it a row for each that a rover carries.
"""

from collections.abc import Iterable
from operator import attrgetter

from harness import samples
from harness.base.sim_time import HIGHEST_RATE
from harness.samples import Sample
from harness.sensors.barometer import BarometerOptions, BarometerSensor, Pressure
from harness.sensors.battery import Battery, BatteryOptions, BatterySensor
from harness.sensors.camera.sensor import CameraOptions, CameraSensor, CameraState
from harness.sensors.depth import DepthOptions
from harness.sensors.gnss import GnssFix, GnssOptions, GnssSensor
from harness.sensors.height_scan import HeightScan, HeightScanOptions, HeightScanSensor
from harness.sensors.lidars import CloudLidarOptions, PlanarLidarOptions
from harness.sensors.magnetometer import MagneticField, MagnetometerOptions, MagnetometerSensor
from harness.sensors.optional import OF_TOPIC
from harness.sensors.ranging import RangeReading, RangeSensor
from harness.sensors.row import SensorRow as SensorRow  # noqa: PLC0414 - plug-ins have it from here
from harness.sensors.row import Topic as Topic  # noqa: PLC0414 - plug-ins have it from here
from rover_metrics.plugins import Table

POINT_CLOUD = "sensor_msgs/msg/PointCloud2"
ATTITUDE = ".attitude"  # behind a sensor's name in --fault: its attitude, not what it measures


# In publishing order. Rates, topics and frames are RoboTerrain's.
SENSORS: tuple[SensorRow, ...] = (
    SensorRow(  # first, so that later samples can be transformed
        sample=samples.Transforms,
        factory="harness.sensors.transforms:TransformSensor",
        topics=(Topic("tf", "tf2_msgs/msg/TFMessage", depth=100),),  # tf2_ros's DynamicBroadcasterQoS
        rate=HIGHEST_RATE,  # at most
        fault="tf",
        measured=("translation",),
    ),
    SensorRow(
        sample=samples.LaserScan,
        factory="harness.sensors.state:LidarSensor",
        topics=(Topic("scan", "sensor_msgs/msg/LaserScan"),),
        rate=20,
        frame=attrgetter("lidar_frame"),
        fault="scan",
        measured=("ranges",),
    ),
    SensorRow(
        sample=samples.Imu,
        factory="harness.sensors.state:ImuSensor",
        topics=(Topic("imu/data", "sensor_msgs/msg/Imu"),),
        rate=20,
        frame=attrgetter("imu_frame"),
        fault="imu",
        measured=("angular_velocity", "linear_acceleration"),
        attitude=("orientation",),
    ),
    SensorRow(
        sample=samples.Pose,
        factory="harness.sensors.state:PoseSensor",
        topics=(Topic("rover/pose_array", "geometry_msgs/msg/PoseArray", best_effort=True),),
        rate=50,
        frame="world",
        fault="pose",
        measured=("position",),
        attitude=("orientation",),
    ),
    SensorRow(
        sample=samples.Odometry,
        factory="harness.sensors.odometry:WheelOdometry",
        topics=(Topic("odometry/wheels", "nav_msgs/msg/Odometry"),),
        rate=attrgetter("odometry_rate"),
        frame="odom",
        fault="odometry",
        measured=("x", "y", "twist"),
        attitude=("yaw",),
    ),
    SensorRow(
        sample=samples.GroundTruth,
        factory="harness.sensors.state:GroundTruthSensor",
        topics=(Topic("odom_ground_truth", "nav_msgs/msg/Odometry"),),
        rate=50,
        frame="odom",
        fault="ground_truth",
        measured=("x", "y", "linear_velocity", "angular_velocity"),
        attitude=("yaw",),
    ),
    SensorRow(
        sample=samples.JointStates,
        factory="harness.sensors.state:JointSensor",
        topics=(Topic("joint_states", "sensor_msgs/msg/JointState"),),
        rate=50,
        fault="joint_states",
        measured=("position", "velocity", "effort"),
    ),
    SensorRow(
        sample=samples.TruthState,
        factory="harness.sensors.state:TruthSensor",
        topics=(
            Topic("rover/truth/contact", "std_msgs/msg/Bool"),
            Topic("rover/truth/traversal", "std_msgs/msg/Float64MultiArray"),
        ),
        rate=20,
    ),
    SensorRow(
        sample=RangeReading,
        factory=RangeSensor,
        topics=(Topic("scan", "sensor_msgs/msg/LaserScan"),),
        fault="lidar2d",
        measured=("ranges",),
        options=PlanarLidarOptions,
        summary="a planar lidar beside the usual one",
    ),
    SensorRow(
        sample=RangeReading,
        factory=RangeSensor,
        topics=(Topic("points", POINT_CLOUD),),
        fault="lidar3d",
        measured=("ranges",),
        options=CloudLidarOptions,
        summary="a lidar with beams at several elevations",
    ),
    SensorRow(
        sample=RangeReading,
        factory=RangeSensor,
        topics=(
            Topic("image", "sensor_msgs/msg/Image"),
            Topic("camera_info", "sensor_msgs/msg/CameraInfo"),
            Topic("points", POINT_CLOUD, option="cloud"),
        ),
        fault="depth",
        measured=("ranges",),
        options=DepthOptions,
        summary="a depth camera",
    ),
    SensorRow(
        sample=CameraState,
        factory=CameraSensor,
        topics=(
            Topic("image_raw", "sensor_msgs/msg/Image", on_demand=True),
            Topic("camera_info", "sensor_msgs/msg/CameraInfo"),
        ),
        fault="camera",
        options=CameraOptions,
        summary="colour camera, pinhole or fisheye, drawn by OpenGL while somebody listens or records",
    ),
    SensorRow(
        sample=GnssFix,
        factory=GnssSensor,
        topics=(Topic("fix", "sensor_msgs/msg/NavSatFix"),),
        fault="gnss",
        measured=("latitude", "longitude", "altitude"),
        options=GnssOptions,
        summary="GNSS receiver on WGS-84",
    ),
    SensorRow(
        sample=MagneticField,
        factory=MagnetometerSensor,
        topics=(Topic("mag", "sensor_msgs/msg/MagneticField"),),
        fault="magnetometer",
        measured=("magnetic_field",),
        options=MagnetometerOptions,
        summary="the Earth's magnetic field in the rover's axes",
    ),
    SensorRow(
        sample=Pressure,
        factory=BarometerSensor,
        topics=(Topic("pressure", "sensor_msgs/msg/FluidPressure"),),
        fault="barometer",
        measured=("fluid_pressure",),
        options=BarometerOptions,
        summary="pressure of the standard atmosphere",
    ),
    SensorRow(
        sample=Battery,
        factory=BatterySensor,
        topics=(
            Topic("battery_state", "sensor_msgs/msg/BatteryState"),
            Topic("motor_currents", "std_msgs/msg/Float64MultiArray"),
        ),
        fault="battery",
        measured=("voltage", "current", "percentage"),
        options=BatteryOptions,
        summary="charge, voltage and current, and the motors' currents; needs real actuators",
    ),
    SensorRow(
        sample=HeightScan,
        factory=HeightScanSensor,
        topics=(Topic("grid_map", "grid_map_msgs/msg/GridMap", option="grid_map"),),
        fault="height_scan",
        measured=("heights",),
        options=HeightScanOptions,
        summary="true heights of ground and obstacles around the rover, on a grid",
    ),
)


OPTIONAL = Table[SensorRow](
    "sensors",
    {str(row.fault): row for row in SENSORS if row.options is not None},
    lambda value: (
        isinstance(value, SensorRow)
        and None not in (value.options, value.fault)
        and all(OF_TOPIC.fullmatch(topic.name) for topic in value.topics)
    ),
    "a harness.sensors.table.SensorRow with `options`, `fault` and topics as points or front/points, no "
    "slash before them",
)


def row_of(sample: type[Sample]) -> SensorRow:
    """Returns the first row whose sensor has this type of sample."""
    return next(row for row in (*SENSORS, *OPTIONAL.loaded().values()) if row.sample is sample)


def by_fault_name(rows: Iterable[SensorRow] | None = None) -> dict[str, SensorRow]:
    """Returns the rows that can have faults, of some or of all, by their names in --fault."""
    return {row.fault: row for row in (SENSORS if rows is None else rows) if row.fault is not None}
