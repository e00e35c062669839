"""The node over real DDS, in this process; its program in test_metrics_program.py."""

import csv
import gc
import json
import math
import random
import shutil
import sys
import time
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseArray
from rclpy._rclpy_pybind11 import RCLError
from rclpy.exceptions import NameValidationException
from rclpy.parameter import Parameter
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64MultiArray, MultiArrayDimension
from std_srvs.srv import SetBool, Trigger

from rover_metrics.core.columns import Row
from rover_metrics.errors import LogError, ParameterError
from rover_metrics.extended.metrics import EXTENDED_HEADER
from rover_metrics.extended.truth_columns import WHEELS, traversal_names
from rover_metrics.health.rejections import BELOW_LIMIT
from rover_metrics.health.watches import STANDS_STILL
from rover_metrics.metrics_node import AHEAD, HOLDS, KEEPS_ORDER, LISTENS_ANEW, SPARE, MetricsNode
from rover_metrics.ros.guarded_node import CLOCKS
from rover_metrics.ros.program import HAS_EVENTS_EXECUTOR
from rover_metrics.topics import SENSORS, TRUTH
from tests.rover_metrics.conftest import Rig

Capsys = pytest.CaptureFixture[str]

SCAN, IMU, POSE, ODOMETRY = SENSORS
GROUND_TRUTH, CONTACT, TRUTH_VALUES = TRUTH


def test_a_row_is_written_every_second_of_the_wall_clock(rig: Rig) -> None:
    node, began = rig.start(), int(time.time())
    rig.spin_until(lambda: node.rows == 2)
    stamps = [int(line.split(b",")[0]) for line in node.log.path.read_bytes().splitlines()[1:]]
    assert began <= stamps[0] < stamps[1] <= time.time()


def test_the_folder_is_told_and_the_log_closed(
    rig: Rig, capfd: Capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(rig.folder))
    node = rig.start(log_dir="~/logs")
    assert node.log.path == rig.folder / "logs/metrics_log_20250116_120457.csv"
    assert f"logging to: {rig.folder}/logs" in capfd.readouterr().err
    rig.end(node)
    with pytest.raises(LogError):
        node.log.write(Row(*[0] * 11))  # type: ignore[arg-type]


def test_the_received_service_tells_what_arrived_and_what_was_written(rig: Rig) -> None:
    node = rig.start()
    rig.publisher(LaserScan, "scan").publish(rig.scan(*(7.0,) * 99_999, 3.5))
    rig.spin_until(lambda: node.received["/scan"] == 1)
    assert node.metrics.clearance == 3.5
    node.periodic_logging()
    client = rig.simulator.create_client(Trigger, "/metrics_node/received")
    rig.spin_until(client.service_is_ready)
    future = client.call_async(Trigger.Request())
    rig.spin_until(future.done)
    answer = future.result()
    assert answer.success
    assert json.loads(answer.message) == {
        "/scan": 1,
        "/imu/data": 0,
        "/rover/pose_array": 0,
        "/odometry/wheels": 0,
        "remarks": {"/scan": {"no stamp": 1}},
        "rows": node.rows,
        "lost_rows": 0,
        "log": str(node.log.path),
    }
    assert node.rows >= 1


@pytest.mark.parametrize("queue", [1, AHEAD])
def test_while_a_simulator_waits_for_this_node_its_queues_are_longer_and_it_says_so(
    rig: Rig, queue: int
) -> None:
    node = rig.start(use_sim_time=True, pose_queue=queue)
    client = rig.simulator.create_client(SetBool, "/metrics_node/lock_step")
    rig.spin_until(client.service_is_ready)
    promise = KEEPS_ORDER + HOLDS.format(AHEAD - SPARE, CLOCKS - SPARE)

    def answer(waits: bool) -> tuple[str, set[int]]:
        future = client.call_async(SetBool.Request(data=waits))
        rig.spin_until(future.done)
        assert (future.result().success, node.in_lock_step) == (True, waits)
        node.begin_spin()
        depths = {s.qos_profile.depth for s in node.subscriptions if s.topic_name in node.received}
        return future.result().message, depths

    own, before = {queue, 10}, {s for s in node.subscriptions if s.topic_name in node.received}
    told, depths = answer(waits=True)
    if HAS_EVENTS_EXECUTOR:
        assert (told, depths) == (promise + LISTENS_ANEW, {AHEAD})
        assert before.isdisjoint(node.subscriptions), "a simulator waits for the new ones of all topics"
        assert answer(waits=True) == (promise, {AHEAD}), "as it listens already"
    else:
        assert (told, depths) == ("", own)
    assert answer(waits=False) == ("", own)
    rig.publisher(LaserScan, "scan").publish(rig.scan(1.0, stamp=1.0))
    rig.spin_until(lambda: node.received["/scan"] == 1)


@pytest.mark.skipif(not HAS_EVENTS_EXECUTOR, reason="no simulator waits for a node without it")
@pytest.mark.parametrize("waits", [True, False])
def test_in_lock_step_a_row_is_written_before_what_came_after(rig: Rig, waits: bool) -> None:
    from rclpy.experimental import EventsExecutor  # noqa: PLC0415 - Humble has none

    node = rig.start(use_sim_time=True)
    node.in_lock_step = waits
    executor = EventsExecutor(context=rig.context)
    executor.add_node(node)
    (clock,) = (each for each in node.subscriptions if each.topic_name == "/clock")
    for second in (1, 2, 3):
        for nanosec in (0, 10_000_000, 990_000_000):
            clock.callback(serialize_message(Clock(clock=Time(sec=second, nanosec=nanosec))))
            assert node.rows == (second if waits else second - (nanosec == 0))
            assert not (waits and node.timer._timer.is_ready()), "it would fire a second time"
            for _ in range(3):
                executor.spin_once(timeout_sec=0.01)
            assert node.rows == second, "the executor's turn comes to nothing more"
    executor.shutdown()
    stamps = [line.split(",")[0] for line in node.log.path.read_text().splitlines()[1:]]
    assert stamps == ["1", "2", "3"]


@pytest.mark.parametrize(("name", "meant"), [("sim_time", "use_sim_time"), ("fsinc", "fsync")])
def test_a_misspelt_parameter_is_told_the_nearest(rig: Rig, name: str, meant: str) -> None:
    with pytest.raises(ParameterError, match=rf"^there is no parameter {name}; did you mean {meant}\?$"):
        rig.start("-p", f"{name}:=true", "-p", "qos_overrides./scan.x:=y", "-p", "of_another_node:=3")


def test_a_parameter_cannot_be_undeclared(rig: Rig) -> None:
    node = rig.start()
    assert not node.set_parameters_atomically([Parameter("debug_interval")]).successful
    assert node.get_parameter("debug_interval").value == 100
    assert node.set_parameters_atomically([Parameter("use_sim_time", value=True)]).successful


def test_a_change_that_is_not_valid_is_rejected(rig: Rig) -> None:
    node = rig.start()
    before = node.settings
    for name, value, reason in (
        ("collision_threshold", math.nan, "Min: 0.0, Max: 100.0"),
        ("collision_threshold", 100.00000001, "from 0.0 to 100.0 m"),
        ("collision_threshold", 1, "a number with a decimal point (1.0, not 1)"),
        ("debug_interval", 0, "Min: 1"),
        ("debug_mode", 1, "must be true or false, not 0 or 1"),
        ("log_dir", "/elsewhere", "read-only"),
        ("extended_columns", True, "fixed once the node runs, for the header of this log is written"),
        ("footprint", [0.0, 0.0, 1.0], "one corner lacks its y"),
        ("lidar_pose", [0, 0, 3], "a list of three numbers with decimal points"),
        ("colision_threshold", 0.3, "there is no parameter colision_threshold; did you mean coll"),
        ("", 0.3, "there is no parameter "),
    ):
        outcome = node.set_parameters_atomically([Parameter(name, value=value)])
        assert (outcome.successful, reason in outcome.reason) == (False, True), name
        assert node.settings == before
        assert node.metrics.thresholds == before.thresholds


def test_every_so_many_scans_and_poses_are_reported(rig: Rig, capfd: Capsys) -> None:
    node = rig.start(debug_mode=True, debug_interval=3)
    for step in range(7):
        node.take(SCAN, rig.scan(0.125, 3.0))
        node.take(POSE, rig.pose(0.25 * step, 0.0, 0.0))
        node.take(IMU, rig.imu((0.0, 0.0, 0.0)))
        node.take(ODOMETRY, rig.odometry(0.0, 0.0, 0.0))
    told = [line.partition("]: ")[2] for line in capfd.readouterr().err.splitlines() if "total" in line]
    assert told == [
        "LIDAR: clearance 0.1250 m, total collisions 3",
        "Position update: distance 0.2500 m, total 0.5000 m",
        "LIDAR: clearance 0.1250 m, total collisions 6",
        "Position update: distance 0.2500 m, total 1.2500 m",
    ]


def test_rows_lost_at_the_end_fail_the_session(rig: Rig, capfd: Capsys) -> None:
    folder = rig.folder / "logs"
    node = rig.start(log_dir=str(folder))
    shutil.rmtree(folder)
    folder.write_text("in the way")
    node.periodic_logging()
    node.log.close()
    assert node.lost_rows == 1
    folder.unlink()
    folder.mkdir()
    rig.end(node)
    outcome = json.loads(node.log.path.with_suffix(".json").read_text())["outcome"]
    assert outcome == {"status": "failed", "reason": "1 rows could not be written"}
    assert "1 rows are lost so far" in capfd.readouterr().err


def cells(node: MetricsNode) -> dict[str, Any]:
    """The cells of a row that is written now."""
    node.periodic_logging()
    assert node.last_row is not None
    return dict(zip(node.last_row.columns, node.last_row.as_fields(), strict=True))


@pytest.mark.parametrize("is_late", [False, True])
def test_every_field_of_every_message_reaches_its_columns(rig: Rig, is_late: bool) -> None:
    """Angles and limits of a scan, the first pose of several, turned IMU, named truth."""
    wide = [-0.2, -0.1, 0.2, -0.1, 0.2, 0.1, -0.2, 0.1]
    extended: dict[str, Any] = {"extended_columns": True, "use_sim_time": True}
    given: dict[str, Any] = {"footprint": wide, "collision_threshold": 1.0, "gravity": 10.0}
    node = rig.start(**extended, **({} if is_late else given))
    if is_late:  # what is set while it runs counts as what it began with
        node.set_parameters_atomically([Parameter(name, value=value) for name, value in given.items()])
    scan = rig.scan(0.5, 3.0, stamp=1.0, limits=(0.6, 2.0))
    scan.angle_min, scan.angle_increment = math.pi / 2, 0.1  # the nearest is on the left
    turned = rig.imu((0.0, 9.6, 2.8), (0.0, 3.0, 4.0), stamp=2.0)
    turned.orientation.x, turned.orientation.w = 0.6, 0.8
    names = list(traversal_names(WHEELS))[::-1]
    truth = Float64MultiArray(data=[0.02, 0.4, 0.3, 0.2, 0.1, 9.0, 0.5, 0.0, 0.0, 0.0])
    truth.layout.dim = [MultiArrayDimension(label=",".join(names), size=10, stride=10)]
    for source, message in (
        (SCAN, scan),
        (IMU, turned),
        *((POSE, rig.pose(*place, stamp=3.5)) for place in ((1.0, 2.0, 2.0), (1.1, 2.2, 2.2))),
        (ODOMETRY, rig.odometry(0.2, 0.3, -0.6, stamp=4.0)),
        (GROUND_TRUTH, rig.odometry(0.3, 0.4, 0.0, stamp=1.0)),
        (CONTACT, Bool(data=True)),
        (TRUTH_VALUES, truth),
    ):
        if source is POSE:
            message.poses = [*message.poses, *rig.pose(9.0, 9.0, 9.0).poses]
        node.take(source, message)
    told = cells(node)
    assert told["Footprint Clearance [m]"] == 0.4
    assert told["Total Collisions"] == told["Collision Events"] == 1
    assert (told["Roughness RMS [m/s^2]"], told["Current Smoothness"]) == (0.0, 15.0)
    assert (told["Distance Traveled"], told["Current Velocity"]) == (0.3, 0.7)
    ages = [told[f"{name} Age [s]"] for name in ("Scan", "IMU", "Pose", "Odometry")]
    assert ages == [-1.0, -2.0, -3.5, -4.0]  # no /clock yet
    assert (told["True Contact Events"], told["True Speed [m/s]"]) == (1, 0.5)
    slips = [told[f"True Slip {wheel.replace('_', ' ').title()}"] for wheel in WHEELS]
    assert (slips, told["True Roughness [m]"]) == ([0.1, 0.2, 0.3, 0.4], 0.02)
    remarks = {topic: [*counts] for topic, counts in node.reception.remarks.items() if counts}
    assert remarks == {"/scan": [BELOW_LIMIT], "/rover/pose_array": [STANDS_STILL]}
    with node.log.path.open(newline="") as file:
        assert [*csv.reader(file)] == [[*EXTENDED_HEADER], [str(cell) for cell in told.values()]]


def test_orientation_and_names_may_be_missing(rig: Rig) -> None:
    node = rig.start(extended_columns=True)
    tilted = rig.imu((1.0, 0.0, 9.8), stamp=1.0)
    tilted.orientation.x, tilted.orientation.w = 0.6, 0.8
    tilted.orientation_covariance[0] = -1.0
    node.take(IMU, tilted)
    node.take(TRUTH_VALUES, Float64MultiArray(data=[0.0] * 9 + [0.02]))
    node.take(CONTACT, Bool(data=False))
    told = cells(node)
    assert told["Roughness RMS [m/s^2]"] == 0.0  # the first sample is gravity
    assert (told["True Roughness [m]"], told["True Contact Share"]) == (0.02, 0.0)


def test_topics_follow_namespace_and_remap_and_losses_have_columns(rig: Rig, capfd: Capsys) -> None:
    remaps = ("-r", "__ns:=/leo", "-r", "scan:=front/scan")
    node = rig.start(*remaps, extended_columns=True, use_sim_time=True)
    sensors = ("front/scan", "imu/data", "rover/pose_array", "odometry/wheels")
    truth = ("odom_ground_truth", "rover/truth/contact", "rover/truth/traversal")
    assert set(node.received) == {f"/leo/{topic}" for topic in (*sensors, *truth)}
    node.take(SCAN, LaserScan())
    node.take(IMU, rig.imu((math.nan, 0.0, 0.0)))
    node.take(POSE, PoseArray())
    node.take(ODOMETRY, rig.odometry(math.inf, 0.0, 0.0))
    node.take(GROUND_TRUTH, rig.odometry(math.nan, 0.0, 0.0))
    node.take(TRUTH_VALUES, Float64MultiArray(data=[1.0]))
    for lost, topic in enumerate(sensors, start=1):
        node.reception.remark(f"/leo/{topic}", "lost on the way", lost)
        node.reception.remark(f"/leo/{topic}", "something else", 50)
    told = cells(node)
    for what, counts in (("Lost", [1, 2, 3, 4]), ("Rejected", [0, 1, 1, 1])):
        assert [told[f"{name} {what}"] for name in ("Scan", "IMU", "Pose", "Odometry")] == counts
    assert told["True Roughness [m]"] == ""
    assert [node.reception.rejected[f"/leo/{topic}"] for topic in truth] == [1, 0, 1]
    assert capfd.readouterr().err.count("not the truth that harness.run publishes, left out") == 2


def test_random_messages_do_no_harm_and_leave_nothing_behind(rig: Rig) -> None:
    node, rng = rig.start(stale_after=0.0), random.Random(7)  # noqa: S311 - no secrets here
    odd = (math.nan, math.inf, -math.inf, 0.0, -1.0, 1e-300, 1e300, -1e308, 427.0, 9.8, 0.1)
    scans = [rig.scan(*rng.choices(odd[:5] + odd[8:], k=size), limits=(0.15, 9.0)) for size in range(9)]
    poses, imu, odometry = rig.pose(0.0, 0.0, 0.0), rig.imu((0.0, 0.0, 0.0)), rig.odometry(0.0, 0.0, 0.0)
    vectors = (imu.linear_acceleration, poses.poses[0].position, odometry.twist.twist.linear)

    def give(messages: int) -> None:
        for number in range(messages):
            for vector in vectors:
                vector.x, vector.y, vector.z = rng.choices(odd, k=3)
            choice = ((SCAN, rng.choice(scans)), (IMU, imu), (POSE, poses), (ODOMETRY, odometry))
            source, message = rng.choice(choice)
            stamp = message.header.stamp
            stamp.sec, stamp.nanosec = rng.choice((0, 1, -(2**31), 2**31 - 1)), rng.randrange(2**32)
            node.take(source, message)
            if number % 1000 == 0:
                node.periodic_logging()
                node.reception.look(number * 10**9, 5 * 10**9)

    give(4000)
    gc.collect()
    before = sys.getallocatedblocks()
    give(16_000)
    gc.collect()
    assert sys.getallocatedblocks() - before < 1000
    assert sum(node.received.values()) == 20_000
    assert node.last_row is not None
    assert all(math.isfinite(float(cell)) for cell in node.last_row.as_fields()[:-1])
    assert all(node.reception.rejected[f"/{name}"] > 0 for name in ("imu/data", "odometry/wheels"))
    assert (node.reception.rejected["/scan"], node.lost_rows) == (0, 0)


@pytest.mark.parametrize(
    "words", [("-r", "__ns:=/" + "a" * 300), ("-r", "scan:=" + "a" * 300), ("-p", "use_sim_time:=maybe")]
)
def test_a_node_that_rcl_refuses_leaves_nothing_behind(rig: Rig, words: tuple[str, str]) -> None:
    with pytest.raises((RCLError, NameValidationException, ParameterError)):
        rig.start(*words)
    assert list(rig.folder.iterdir()) == []
