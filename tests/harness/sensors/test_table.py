"""A sensor is one file and one row: the barometer is in every part of a run by that alone."""

from importlib import import_module
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

from harness.base.errors import UsageError
from harness.base.sim_time import period_ticks
from harness.episode.episode import Episode
from harness.faults.injector import FaultInjector
from harness.faults.lookup import describe_faults
from harness.robots import ROVERS, find_rover
from harness.samples import Tick, TruthState
from harness.sensors.barometer import Pressure
from harness.sensors.base import Sensor
from harness.sensors.choice import by_default
from harness.sensors.lidar_spec import LidarSpec
from harness.sensors.table import SENSORS, SensorRow, by_fault_name
from harness.spec.ros import FrameOptions
from harness.spec.run import Run
from tests.support.rovers import LEO
from tests.support.rovers import ROVER_ZERO4WD as ZERO
from tests.support.words import parse_faults

BEAMS = 8
RUN: Any = {
    "terrain": "flat",
    "driver": "spin",
    "lidar_beams": BEAMS,
    "duration": 1.0,
    "sensors": ("barometer",),
}


@pytest.fixture(scope="module")
def ticks() -> tuple[Tick, ...]:
    """Of one second with a barometer that says 7 from 0.5 s on, and never anything in between."""
    config = Run.of(**RUN)
    faults = FaultInjector(
        parse_faults(["barometer:stuck=7@0.5", "imu:dropout"]), seed=0, rows=config.sensor_rows()
    )
    batches = Episode(config).batches()
    return tuple(faults.corrupt(tick) for batch in batches for tick in batch.ticks)


def pressures(ticks: tuple[Tick, ...]) -> list[Pressure]:
    return [sample for tick in ticks for sample in tick.samples if isinstance(sample, Pressure)]


def test_a_new_row_is_read_at_its_rate_and_has_faults_of_its_own(ticks: tuple[Tick, ...]) -> None:
    told = pressures(ticks)
    assert [p.stamp_ns / 1e9 for p in told] == [n / 10 for n in range(1, 11)]
    assert all(85_000.0 < p.fluid_pressure < 87_000.0 for p in told[:4])  # of the datum's altitude
    assert {p.fluid_pressure for p in told[4:]} == {7.0}


def test_a_new_row_is_in_the_help() -> None:
    assert "barometer, height_scan, imu.attitude" in describe_faults().splitlines()[0]


@pytest.fixture
def recording(ticks: tuple[Tick, ...], ros_domain: int, tmp_path: Path) -> Path:
    """What the bridge has published of them."""
    rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    from harness.ros.bridge import Bridge  # noqa: PLC0415 - the other tests need no ROS
    from harness.ros.recorder import Recorder  # noqa: PLC0415

    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain)
    bridge = Bridge(
        find_rover("leo"),
        LidarSpec(beams=BEAMS),
        context=context,
        rows=Run.of(**RUN).sensor_rows(),
    )
    with Recorder(tmp_path / "bag.mcap") as recorder:
        recorder.tap(bridge)
        for tick in ticks:
            bridge.advance(tick, tick, listeners=(Mock(),))
    assert bridge.published()["/barometer/pressure"] == 10
    bridge.destroy_node()
    context.shutdown()
    return tmp_path / "bag.mcap"


def test_a_mount_is_a_frame_of_the_urdf_and_of_tf_static() -> None:
    description = Episode(Run.of(**RUN), FrameOptions()).description
    assert description is not None
    (edge,) = (edge for edge in description.fixed if edge.child == "barometer_link")
    assert edge.parent == "base_footprint"
    assert edge.translation == pytest.approx((0.174, 0.0, 0.798))
    assert '<link name="barometer_link"' in description.urdf


def test_without_being_asked_for_there_is_none() -> None:
    config = Run.of(**RUN | {"sensors": None})
    assert "barometer" not in {row.source for row in config.sensor_rows()}
    with pytest.raises(UsageError, match=r"no sensor 'barometer', but --sensors barometer adds it"):
        config.alone(faults=("barometer:nan",)).validate()


def test_a_new_row_is_published_and_recorded_without_a_line_for_its_message(
    recording: Path, ticks: tuple[Tick, ...]
) -> None:
    from rosbags.highlevel import AnyReader  # noqa: PLC0415 - the other tests need no recording

    with AnyReader([recording]) as bag:
        (connection,) = (c for c in bag.connections if c.topic == "/barometer/pressure")
        assert connection.msgtype == "sensor_msgs/msg/FluidPressure"
        told = [bag.deserialize(data, c.msgtype) for c, _, data in bag.messages([connection])]
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in told]  # type: ignore[attr-defined]
    values = [(m.fluid_pressure, m.variance) for m in told]  # type: ignore[attr-defined]
    assert stamps == [p.stamp_ns for p in pressures(ticks)]
    assert values == [(p.fluid_pressure, p.variance) for p in pressures(ticks)]
    assert {m.header.frame_id for m in told} == {"barometer_link"}  # type: ignore[attr-defined]


@pytest.mark.parametrize("row", by_default(), ids=lambda row: row.sample.__name__)
def test_every_row_has_a_valid_rate_on_every_rover_and_fields_that_its_sample_has(
    row: SensorRow,
) -> None:
    assert all(period_ticks(row.rate_on(rover)) for rover in ROVERS.values())
    # In the order in which faults draw their random numbers.
    assert list(row.measured) == [n for n in row.sample.__dataclass_fields__ if n in row.measured]


# docs/design.md, "Contracts": type, rate [Hz] and frame, of Leo and of rover_zero4wd where they differ.
PROMISED: dict[str, tuple[Any, ...]] = {
    "tf": ("tf2_msgs/msg/TFMessage", (100, "")),
    "scan": ("sensor_msgs/msg/LaserScan", (20, "lidar_link")),
    "imu/data": ("sensor_msgs/msg/Imu", (20, "imu_frame"), (20, "imu_link")),
    "rover/pose_array": ("geometry_msgs/msg/PoseArray", (50, "world")),
    "odometry/wheels": ("nav_msgs/msg/Odometry", (20, "odom"), (50, "odom")),
    "odom_ground_truth": ("nav_msgs/msg/Odometry", (50, "odom")),
    "joint_states": ("sensor_msgs/msg/JointState", (50, "")),
    "rover/truth/contact": ("std_msgs/msg/Bool", (20, "")),
    "rover/truth/traversal": ("std_msgs/msg/Float64MultiArray", (20, "")),
}  # of the optional ones: docs/sensors.md, which test_page.py holds


def test_every_rover_has_these_sensors_of_these_types_at_these_rates_and_in_these_frames() -> None:
    rows = [(topic, row) for row in SENSORS if row.options is None for topic in row.topics]
    told = {
        t.name: (t.message_type, *((r.rate_on(v), r.frame_on(v)) for v in (LEO, ZERO))) for t, r in rows
    }
    assert told == {name: (kind, of[0], of[-1]) for name, (kind, *of) in PROMISED.items()}
    assert list(told) == list(PROMISED)  # published in this order


def test_topics_have_the_qos_that_is_promised() -> None:
    topics = [topic for row in by_default() for topic in row.topics]
    assert [topic.name for topic in topics if topic.best_effort] == ["rover/pose_array"]
    assert {topic.name: topic.depth for topic in topics if topic.depth != 10} == {"tf": 100}
    assert [topic.name for topic in topics if topic.on_demand] == ["camera/image_raw"]
    assert not any(topic.latched for topic in topics)


# What faults of values change: what is measured, and the attitude, which is only changed where told.
FAULTY = {
    "tf": (["translation"], []),
    "scan": (["ranges"], []),
    "imu": (["angular_velocity", "linear_acceleration"], ["orientation"]),
    "pose": (["position"], ["orientation"]),
    "odometry": (["x", "y", "twist"], ["yaw"]),
    "ground_truth": (["x", "y", "linear_velocity", "angular_velocity"], ["yaw"]),
    "joint_states": (["position", "velocity", "effort"], []),
    "lidar2d": (["ranges"], []),
    "lidar3d": (["ranges"], []),
    "depth": (["ranges"], []),
    "camera": ([], []),
    "gnss": (["latitude", "longitude", "altitude"], []),
    "magnetometer": (["magnetic_field"], []),
    "barometer": (["fluid_pressure"], []),
    "height_scan": (["heights"], []),
}


def test_faults_change_what_a_sensor_measures_and_its_attitude_apart() -> None:
    rows = by_fault_name(by_default())
    assert {name: (list(r.measured), list(r.attitude)) for name, r in rows.items()} == FAULTY
    assert [r.sample for r in by_default() if r.fault is None] == [TruthState]
    assert (set(by_fault_name()), by_fault_name(())) == (set(FAULTY), {})


@pytest.mark.parametrize(
    ("part", "needed_by"),
    [
        ("lidar", {"scan"}),
        ("surroundings", {"lidar2d", "lidar3d", "depth"}),
        ("datum", {"gnss", "magnetometer", "barometer"}),
        ("frames", {"tf"}),
        ("frame_options", {"tf"}),
        ("recorder", {None}),  # the truth
        ("simulation", {*FAULTY}),
    ],
)
def test_a_run_without_a_part_lacks_what_is_made_of_it(part: str, needed_by: set[str | None]) -> None:
    assert {row.fault for row in by_default() if part in row.parts} == needed_by


def test_every_reader_is_where_the_table_has_it() -> None:
    for module, _, name in (row.reader.partition(":") for row in SENSORS if row.reader):
        assert issubclass(getattr(import_module(module), name), Sensor)
