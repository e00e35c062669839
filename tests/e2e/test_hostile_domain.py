"""Whoever can publish in the domain sends what no sensor and no client should: both programs log on."""

import array
import csv
import json
import math
import random
import signal
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from tests.support.forked_program import ForkedProgram
from tests.support.waiting import PATIENCE

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, PoseArray, Twist, Vector3
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.executors import SingleThreadedExecutor
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Bool, Float64MultiArray, Header, MultiArrayDimension
from std_srvs.srv import SetBool, Trigger

from rover_metrics.health.rejections import NO_TIME

ROUNDS = 9
WARM = 3  # rounds until what a process keeps for good is there
ANSWER = 2.0  # [s] until a request is sent again
MOST_GROWTH = 4_000  # kB; a few of the scans that come meanwhile, 400 kB each, would be more
FLOATS = (math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, -0.0, 1.0)
BROKEN_TIMES = ((-1, 0), (-(2**31), 2**32 - 1), (3, 10**9), (2**31 - 1, 2**32 - 1))
NAMES = ("collision_threshold", "use_sim_time", "footprint", "no such", "ä\x01" * 40)
VALUES = (
    ParameterValue(type=0),
    ParameterValue(type=77),
    ParameterValue(type=2, integer_value=-(2**63)),
    ParameterValue(type=3, double_value=math.nan),
    ParameterValue(type=4, string_value="\x1b[2J" * 9),
    ParameterValue(type=8, double_array_value=[math.inf] * 5),
    ParameterValue(type=9, string_array_value=["", "x"]),
)
ALONE, HOSTED, HARNESS = "/alone/metrics_node", "/metrics_node", "/harness"
NODE = ["--ros-args", "-p", "use_sim_time:=true"]
APART = ["-p", "extended_columns:=true", "-r", "__ns:=/alone", "-r", "/clock:=/alone/clock"]
RUN = ["--terrain", "flat", "--driver", "spin", "--duration", "36000"]


class Enemy:
    """Broken messages and requests, from a seed, and the answers to them."""

    def __init__(self, at_end: ExitStack) -> None:
        self.random = random.Random(13)  # noqa: S311 - no secrets here
        context = rclpy.Context()
        rclpy.init(context=context)
        at_end.callback(context.try_shutdown)
        self.node = rclpy.create_node("enemy", context=context)
        self.executor = at_end.enter_context(SingleThreadedExecutor(context=context))
        self.executor.add_node(self.node)
        self._publishers: dict[str, Any] = {}
        self._clients: dict[str, Any] = {}

    def wait(self, condition: Callable[[], object]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, "the condition did not come true"
            self.executor.spin_once(timeout_sec=0.02)

    def publish(self, topic: str, message: Any, *, raw: bytes | None = None) -> None:  # noqa: ANN401
        """Sends a message, or these bytes for one of its type."""
        publisher = self._publishers.get(topic)
        if publisher is None:
            publisher = self.node.create_publisher(type(message), topic, 10)
            self._publishers[topic] = publisher
            self.wait(publisher.get_subscription_count)
        publisher.publish(message if raw is None else raw)

    def ask(self, kind: Any, service: str, **request: Any) -> Any:  # noqa: ANN401
        """The answer to a request."""
        if service not in self._clients:
            self._clients[service] = self.node.create_client(kind, service)
            self.wait(self._clients[service].service_is_ready)
        deadline = time.monotonic() + PATIENCE
        while True:  # an answer is lost while the node does not know this client yet
            future = self._clients[service].call_async(kind.Request(**request))
            self.executor.spin_until_future_complete(future, timeout_sec=ANSWER)
            if future.done():
                return future.result()
            assert time.monotonic() < deadline, f"{service} does not answer"

    def ask_and_be_gone(self, kind: Any, service: str) -> None:  # noqa: ANN401
        """A request whose answer finds nobody."""
        client = self.node.create_client(kind, service)
        self.wait(client.service_is_ready)
        client.call_async(kind.Request())
        self.node.destroy_client(client)

    def received(self, node: str) -> dict[str, Any]:
        values: dict[str, Any] = json.loads(self.ask(Trigger, f"{node}/received").message)
        return values

    def left_out(self, node: str, clock: str) -> int:
        return int(self.received(node)["remarks"].get(clock, {}).get(NO_TIME, 0))

    # What it sends

    def number(self) -> float:
        return self.random.choice(FLOATS)

    def vector(self) -> Vector3:
        return Vector3(x=self.number(), y=self.number(), z=self.number())

    def header(self) -> Header:
        sec = self.random.choice((-(2**31), -1, 0, 2**31 - 1))
        return Header(stamp=Time(sec=sec, nanosec=self.random.randrange(2**32)), frame_id="\x00ö" * 99)

    def messages(self) -> dict[str, Any]:
        """A broken message of each type that metrics_node listens to."""
        beams = self.random.choice((0, 1, 100_000))
        imu = Imu(header=self.header(), linear_acceleration=self.vector())
        imu.angular_velocity, imu.orientation.w = self.vector(), self.number()
        odometry = Odometry(header=self.header())
        odometry.twist.twist.linear = self.vector()
        position = Point(x=self.number(), y=self.number(), z=self.number())
        values = Float64MultiArray(data=[self.number()] * self.random.choice((0, 3, 9000)))
        values.layout.dim = [MultiArrayDimension(label="slip,,,tilt" * self.random.randrange(3))] * 2
        return {
            "scan": LaserScan(
                header=self.header(),
                ranges=array.array("f", [self.random.choice((math.nan, -math.inf, -1.0))]) * beams,
                angle_increment=math.nan,
                range_min=math.inf,
                range_max=-1.0,
            ),
            "imu/data": imu,
            "rover/pose_array": PoseArray(
                header=self.header(), poses=[Pose(position=position)] * self.random.choice((0, 1, 50))
            ),
            "odometry/wheels": odometry,
            "odom_ground_truth": odometry,
            "rover/truth/contact": Bool(data=True),
            "rover/truth/traversal": values,
        }

    def torn(self, message: Any) -> bytes:  # noqa: ANN401
        """A message's bytes, cut off or, behind a stamp, with a length beyond all memory."""
        whole = bytes(serialize_message(message))
        if hasattr(message, "header") and self.random.random() < 0.5:
            return whole[:12] + b"\xff" * 4 + whole[16:]
        return whole[: self.random.randrange(1, 5)]

    def requests(self, node: str) -> None:
        """Asks for parameters that are none; each is refused with a reason, whatever it is."""
        name, value = self.random.choice(NAMES), self.random.choice(VALUES)
        wishes = [Parameter(name=name, value=value), Parameter(name="debug_mode", value=VALUES[1])]
        told = self.ask(SetParameters, f"{node}/set_parameters", parameters=wishes).results
        assert [each.successful for each in told] == [value.type == 0 and told[0].successful, False]
        assert "77 is not a valid" in told[1].reason
        told = self.ask(
            SetParametersAtomically, f"{node}/set_parameters_atomically", parameters=wishes[::-1]
        ).result
        assert not told.successful
        assert "77 is not a valid" in told.reason
        self.ask(GetParameters, f"{node}/get_parameters", names=[name, "use_sim_time"])
        self.ask(ListParameters, f"{node}/list_parameters", prefixes=[name], depth=2**64 - 1)


def rows(folder: Path) -> int:
    return sum(len(path.read_bytes().splitlines()) - 1 for path in folder.glob("*.csv"))


def footprint(process: ForkedProgram) -> tuple[int, int]:
    """Memory [kB] and open files of a process."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    (line,) = [line for line in status.splitlines() if line.startswith("VmRSS")]
    return int(line.split()[1]), len(list(Path(f"/proc/{process.pid}/fd").iterdir()))


@pytest.mark.usefixtures("ros_domain")
def test_broken_messages_and_requests_neither_end_nor_bloat_a_program_nor_cost_a_row(
    tmp_path: Path,
) -> None:
    alone, hosted = tmp_path / "alone", tmp_path / "hosted"
    node = [*NODE, "-p", f"log_dir:={alone}", *APART]
    run = [*RUN, "--rate", "2", "--extended", "--log-dir", str(hosted), "--lidar-beams", "8"]
    with ExitStack() as at_end:
        programs = [
            at_end.enter_context(
                ForkedProgram("rover_metrics.metrics_node", node, tmp_path / "alone.txt")
            ),
            at_end.enter_context(ForkedProgram("harness.run", run, tmp_path / "hosted.txt")),
        ]
        enemy = Enemy(at_end)
        enemy.wait(lambda: rows(hosted) > 0)  # a run that finds strangers at its start is refused
        for second in range(ROUNDS):
            attack(enemy, second)
            if second == WARM:
                before = [footprint(process) for process in programs]
        growth = [
            (memory - then, files - opened)
            for (memory, files), (then, opened) in zip(map(footprint, programs), before, strict=True)
        ]
        assert all(kilobytes < MOST_GROWTH and files <= 2 for kilobytes, files in growth), growth
        account = enemy.received(HOSTED)
        enemy.wait(lambda: enemy.received(HOSTED)["rows"] > account["rows"])
        for process in programs:
            process.send_signal(signal.SIGINT)
        codes = [process.wait(PATIENCE) for process in programs]
    said = [process.said.read_text() for process in programs]
    assert codes == [0, 130], said
    assert "Traceback" not in "".join(said)
    assert "0 lost" in said[1]
    check(alone, list(range(1, ROUNDS + 1)), f"{ALONE}/set_parameters", "/alone/clock")
    check(hosted, list(range(1, account["rows"] + 1)), f"{HOSTED}/set_parameters", "/clock")


def attack(enemy: Enemy, second: int) -> None:
    """One of everything to each program, which must answer; one full second for the node alone."""
    messages = enemy.messages()
    for topic, message in messages.items():
        enemy.publish(f"/alone/{topic}", message, raw=enemy.torn(message))
        enemy.publish(f"/alone/{topic}", message)
        if "pose" not in topic:  # of which only the newest waits: it would push out the run's own
            enemy.publish(f"/{topic}", message, raw=enemy.torn(message))
    sec, nanosec = BROKEN_TIMES[second % len(BROKEN_TIMES)]
    enemy.publish("/cmd_vel", Twist(linear=enemy.vector(), angular=enemy.vector()))
    for clock, name in (("/alone/clock", ALONE), ("/clock", HOSTED)):
        while enemy.left_out(name, clock) <= second:  # best effort: the run's own may stand in its place
            enemy.publish(clock, Clock(clock=Time(sec=sec, nanosec=nanosec)))
    for name in (ALONE, HOSTED, HARNESS):
        enemy.requests(name)
        enemy.ask_and_be_gone(Trigger, f"{name}/{'reset' if name == HARNESS else 'received'}")
    for pause in (True, False):
        enemy.ask(SetBool, f"{HARNESS}/pause", data=pause)
    reliable = [f"/alone/{topic}" for topic in messages if "pose" not in topic]
    heard = dict.fromkeys(["rows", *reliable], second + 1)

    def all_is_heard() -> bool:
        # Again and again: best effort, so it is lost while its reader does not know the publisher yet.
        enemy.publish("/alone/clock", Clock(clock=Time(sec=second + 1)))
        return heard.items() <= enemy.received(ALONE).items()

    enemy.wait(all_is_heard)


def check(folder: Path, seconds: list[int], *accounts: str) -> None:
    """The log has a row for each second, its record the account of what was left out."""
    (path,) = folder.glob("*.csv")
    with path.open(newline="") as file:
        assert [int(row["Timestamp"]) for row in csv.DictReader(file)][: len(seconds)] == seconds
    record = json.loads(path.with_suffix(".json").read_text())
    topics = (record["node"] if "hosted" in folder.name else record)["topics"]
    for name in accounts:
        assert topics[name]["rejected"] >= ROUNDS
        assert topics[name]["received"] is None
