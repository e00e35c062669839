"""Whoever can publish in the domain sends what no sensor and no client should: all programs go on.

What is attacked stands in no list: it is every subscription that the graph shows of the programs.
"""

import array
import csv
import json
import math
import random
import signal
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.documents import ROOT
from tests.support.forked_program import ForkedProgram
from tests.support.ros import Ros
from tests.support.waiting import PATIENCE

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool, Trigger

from harness.messages.transforms import TF_MESSAGE
from harness.ros.foreign_type import forget_missing_definition
from harness.ros.topic_monitor import message_class
from rover_metrics.health.rejections import NO_TIME

ROUNDS = 12
WARM = 3  # rounds until most of what a process keeps for good is there
MOST_GROWTH = 600, 0  # kB and files a round; two of the scans that come in each have 800 kB
MOST_SAID = 200_000  # bytes
FLOATS = (math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, -0.0, 1.0)
TEXTS = ("", "odom", "slip,,,tilt", "\x1b[2J\x00ö" * 999)
BROKEN_TIMES = ((-1, 0), (-(2**31), 2**32 - 1), (3, 10**9), (2**31 - 1, 2**32 - 1))
NAMES = ("collision_threshold", "use_sim_time", "footprint", "no such", "ä\x01" * 40)
VALUES = (
    ParameterValue(type=0),
    ParameterValue(type=77),
    ParameterValue(type=1),
    ParameterValue(type=2, integer_value=-(2**63)),
    ParameterValue(type=3, double_value=math.nan),
    ParameterValue(type=4, string_value="\x1b[2J" * 9),
    ParameterValue(type=8, double_array_value=[math.inf] * 5),
    ParameterValue(type=9, string_array_value=["", "x"]),
)
# A switch may be set by anybody, of a node that no run waits for.
WISHES = [(n, value) for n in NAMES for value in VALUES if (n, value.type) != ("use_sim_time", 1)]
ALONE, HOSTED, HARNESS = "/alone/metrics_node", "/metrics_node", "/harness"
CLOCKS = {ALONE: "/alone/clock", HOSTED: "/clock"}
ORDERS = {"/cmd_vel", "/initialpose", "/goal_pose"}
TOLD = {  # besides /tf, to which a run listens as soon as somebody else publishes it
    "rover_metrics.metrics_node": {"/alone/scan", "/alone/rover/truth/traversal"},
    "harness.run": {*ORDERS, "/scan", "/clock"},
    "harness.topics": {"/rover/metrics", "/joint_states", "/robot_description"},
    "harness.gym.policy_node": {"/policy/scan", "/policy/goal_pose"},
}


class Enemy:
    """Broken messages and requests, from a seed, and the answers to them."""

    def __init__(self, ros: Ros) -> None:
        self.random = random.Random(13)  # noqa: S311 - no secrets here
        self.node, self.until = ros.node("enemy"), ros.until
        self.ask = partial(ros.ask, self.node)
        self._publishers: dict[str, Any] = {}

    def publish(self, topic: str, kind: Any, message: Any) -> None:  # noqa: ANN401
        """Sends a message, or bytes for one of that type."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(kind, topic, 10)
            forget_missing_definition()
            self.until(self._publishers[topic].get_subscription_count)
        self._publishers[topic].publish(message)

    def ask_and_be_gone(self, kind: Any, service: str) -> None:  # noqa: ANN401
        """A request whose answer finds nobody."""
        client = self.node.create_client(kind, service)
        self.until(client.service_is_ready)
        client.call_async(kind.Request())
        self.node.destroy_client(client)

    def received(self, node: str) -> dict[str, Any]:
        values: dict[str, Any] = json.loads(self.ask(Trigger, f"{node}/received").message)
        return values

    def left_out(self, node: str) -> int:
        return int(self.received(node)["remarks"].get(CLOCKS[node], {}).get(NO_TIME, 0))

    def subscriptions(self) -> dict[str, str]:
        """Every topic that somebody else listens to, and its type, as the graph shows them."""
        found: dict[str, str] = {}
        for name, namespace in set(self.node.get_node_names_and_namespaces()) - {("enemy", "/")}:
            told = self.node.get_subscriber_names_and_types_by_node(name, namespace)
            found |= {topic: kinds[0] for topic, kinds in told}
        return found

    def attack(self, topic: str, name: str) -> None:
        """Sends broken bytes to a topic, and a whole message that no sensor should send.

        A run's own sensors are not told any: they would be a second publisher's, which ends the run.
        """
        kind = message_class(name)
        assert kind is not None
        is_made = name == TF_MESSAGE
        whole = b"\x00\x01\x00\x00" + b"\xff" * 4 if is_made else self.spoilt(kind())
        data = whole if is_made else bytes(serialize_message(whole))
        if hasattr(whole, "header") and self.random.random() < 0.5:
            torn = data[:12] + b"\xff" * 4 + data[16:]  # behind a stamp, a length beyond all memory
        else:
            torn = data[: self.random.randrange(1, 5)]
        if topic != "/rover/pose_array":  # of which only the newest waits: it would push out the run's
            self.publish(topic, kind, torn)
        if kind is not Clock and (topic.startswith(("/alone/", "/policy/")) or topic in ORDERS):
            for _ in range(30 if topic == "/goal_pose" else 1):
                self.publish(topic, kind, whole)

    def spoilt(self, message: Any) -> Any:  # noqa: ANN401
        """A message with extreme values in all of its fields."""
        for field, kind in message.get_fields_and_field_types().items():
            value, draw = getattr(message, field), self.random.choice
            if hasattr(value, "get_fields_and_field_types"):
                self.spoilt(value)
            elif isinstance(value, str):
                setattr(message, field, draw(TEXTS))
            elif isinstance(value, bool):
                setattr(message, field, True)
            elif isinstance(value, float):
                setattr(message, field, draw(FLOATS[:3] if kind == "float" else FLOATS))
            elif isinstance(value, int):
                bits = int(kind.removeprefix("u").removeprefix("int"))
                least = 0 if kind.startswith("u") else -(2 ** (bits - 1))
                setattr(message, field, draw((least, least + 2**bits - 1, 0)))
            elif isinstance(value, np.ndarray):
                value[:] = draw(FLOATS)
            elif isinstance(value, array.array):
                value.extend(
                    [draw(FLOATS[:3]) if value.typecode in "fd" else 0] * draw((0, 1, 9000, 100_000))
                )
            elif "/" in kind:
                element = message_class("/msg/".join(kind[kind.index("<") + 1 : -1].split("/")))
                assert element is not None
                setattr(message, field, [self.spoilt(element()) for _ in range(draw((0, 1, 50)))])
        return message

    def requests(self, node: str) -> None:
        """Asks for parameters that are none; each is refused with a reason, whatever it is."""
        name, value = self.random.choice(WISHES)
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


def test_broken_messages_and_requests_neither_end_nor_bloat_a_program_nor_cost_a_row(
    ros: Ros, tmp_path: Path
) -> None:
    alone, hosted, policy = tmp_path / "alone", tmp_path / "hosted", ROOT / "examples/point_nav.npz"
    apart = ["--ros-args", "-p", "use_sim_time:=true", "-r", "/clock:=/alone/clock"]
    extended = ["-p", "extended_columns:=true", "-p", f"log_dir:={alone}"]
    run = ["--terrain", "flat", "--driver", "spin", "--duration", "36000", "--lidar-beams", "8"]
    words = {
        "rover_metrics.metrics_node": [*apart, "-r", "__ns:=/alone", *extended],
        "harness.run": [*run, "--rate", "2", "--extended", "--log-dir", str(hosted)],
        "harness.gym.policy_node": [str(policy), "--goal", "3,1", *apart, "-r", "__ns:=/policy"],
        "harness.topics": [],
    }
    with ExitStack() as at_end:
        programs = {
            name: at_end.enter_context(ForkedProgram(name, given, tmp_path / f"{name}.txt"))
            for name, given in words.items()
        }
        enemy = Enemy(ros)
        enemy.until(lambda: rows(hosted) > 0)  # a run that finds strangers at its start is refused
        due = {topic for topics in TOLD.values() for topic in topics}
        enemy.until(lambda: due <= enemy.subscriptions().keys())
        attacked, held = set[str](), list[list[tuple[int, int]]]()
        for second in range(ROUNDS):
            found = {**enemy.subscriptions(), "/tf": TF_MESSAGE}
            for topic, name in sorted(found.items()):
                enemy.attack(topic, name)
            attacked |= found.keys()
            confuse(enemy, second)
            held.append([footprint(process) for process in programs.values()])
        assert enemy.subscriptions().keys() <= attacked
        growth = np.median(np.diff(held[WARM:], axis=0), axis=0)  # a buffer that grows once is no leak
        assert np.all(growth <= MOST_GROWTH), held
        account = enemy.received(HOSTED)
        enemy.until(lambda: enemy.received(HOSTED)["rows"] > account["rows"])
        for process in programs.values():
            process.send_signal(signal.SIGINT)
        codes = [process.wait(PATIENCE) for process in programs.values()]
    said = {name: process.said.read_text() for name, process in programs.items()}
    assert codes == [0, 130, 0, 0], said
    for text in list(said.values())[:3]:  # the table of topics is drawn with escapes
        assert "Traceback" not in text
        assert not {"\x1b[2J", "\x00"} & {text[i : i + n] for i in range(len(text)) for n in (1, 4)}
        assert len(text) < MOST_SAID
    assert "0 lost" in said["harness.run"]
    assert "/tf: fails with ValueError" in said["harness.run"]
    check(alone, list(range(1, ROUNDS + 1)), f"{ALONE}/set_parameters", "/alone/clock")
    check(hosted, list(range(1, account["rows"] + 1)), f"{HOSTED}/set_parameters", "/clock")


def confuse(enemy: Enemy, second: int) -> None:
    """Clocks without a time and all requests; then one full second for the node alone."""
    sec, nanosec = BROKEN_TIMES[second % len(BROKEN_TIMES)]
    for name, clock in CLOCKS.items():
        while enemy.left_out(name) <= second:  # best effort: the run's own may stand in its place
            enemy.publish(clock, Clock, Clock(clock=Time(sec=sec, nanosec=nanosec)))
    for name in (ALONE, HOSTED, HARNESS):
        enemy.requests(name)
        enemy.ask_and_be_gone(Trigger, f"{name}/{'reset' if name == HARNESS else 'received'}")
    for pause in (True, False):
        enemy.ask(SetBool, f"{HARNESS}/pause", data=pause)
    wall_time = Parameter(name="use_sim_time", value=ParameterValue(type=1, bool_value=False))
    (told,) = enemy.ask(SetParameters, f"{HOSTED}/set_parameters", parameters=[wall_time]).results
    assert (told.successful, "use_sim_time stays true" in told.reason) == (False, True)
    heard = {"rows": second + 1}

    def all_is_heard() -> bool:
        # Again and again: best effort, so it is lost while its reader does not know the publisher yet.
        enemy.publish(CLOCKS[ALONE], Clock, Clock(clock=Time(sec=second + 1)))
        return heard.items() <= enemy.received(ALONE).items()

    enemy.until(all_is_heard)


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
