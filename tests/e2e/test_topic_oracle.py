"""Every field of every message of a run, over DDS and in the recording, against raw MuJoCo states.

Both rovers drive over real DDS from a level start up a slope, over a rock and a hump, against a wall,
back, round, and after a reset once more. A twin drives the same by MuJoCo alone (topic_oracle/twin.py);
what each message must say is computed from its states (topic_oracle/expected.py).
"""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.waiting import PATIENCE

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import Twist as TwistMessage
from geometry_msgs.msg import Vector3
from mcap.reader import make_reader
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rosbags.highlevel import AnyReader
from std_srvs.srv import Trigger

from harness.base.interrupt import StopRequest
from harness.base.message_types import typestore
from harness.episode import assembly
from harness.episode.batch import Batch
from harness.episode.loop import Pacer
from harness.episode.result import Outputs, RunResult
from harness.episode.stream import RoverOrders
from harness.robots import RoverSpec
from harness.ros.bridge import Bridge
from harness.ros.context import spin_until
from harness.ros.foreign_type import forget_missing_definition
from harness.ros.network import reserved_domain
from harness.ros.session import run_through_ros
from harness.ros.topic_monitor import message_class
from harness.samples import Twist
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from tests.e2e.topic_oracle.expected import BEAMS, Topic, differences, topics
from tests.e2e.topic_oracle.form import Expected
from tests.e2e.topic_oracle.ranging import EARTH, THING
from tests.e2e.topic_oracle.stage import (
    BATCHES,
    PERSON,
    RESET,
    SCRIPT,
    peopled,
    stage,
    staged_rover,
)
from tests.e2e.topic_oracle.surroundings import BASE
from tests.e2e.topic_oracle.twin import TICK_NS, Twin

TICKS_PER_BATCH = 5
TABLE = {topic.name: topic for topic in topics()}
UNHEARD = ("/map", "/cmd_vel", "/rover/metrics")  # are recorded too, and tested elsewhere
KINDS = {name: message_class(topic.kind) for name, topic in TABLE.items()}

RELIABILITY = (ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE)

Arrived = tuple[str, bytes]


@dataclass
class Listener:
    """Hears every topic, drives by /cmd_vel and asks for the reset; lives in the run's executor."""

    bridge: Any = None
    heard: list[Arrived] = field(default_factory=list)
    taken: list[Twist] = field(default_factory=list)
    offered: dict[str, tuple[str, bool, bool]] = field(default_factory=dict)
    batches: int = 0
    clocks: int = 0
    answer: Any = None
    joined: float = 0.0
    drove_s: float = 0.0

    def join(self, bridge: Bridge) -> None:
        """Subscribes to all that the bridge offers, before its first message."""
        self.bridge = bridge
        node = rclpy.create_node("listener", context=bridge.context, enable_rosout=False)
        bridge.executor.add_node(node)
        for name, kind in KINDS.items():
            qos = QoSProfile(depth=1000, reliability=RELIABILITY[TABLE[name].reliable])
            node.create_subscription(kind, name, self._note(name), qos, raw=True)
            forget_missing_definition()
        self.node, self.sender = node, node.create_publisher(TwistMessage, "/cmd_vel", 10)
        self.resetter = node.create_client(Trigger, "/harness/reset")
        self._until(lambda: all(c.publisher.get_subscription_count() for c in bridge.channels))
        self._until(lambda: self.sender.get_subscription_count() > 0)
        self._until(self.resetter.service_is_ready)
        self.joined = time.monotonic()
        for name in {c.topic for c in bridge.channels}:
            (info,) = node.get_publishers_info_by_topic(name)
            reliable = info.qos_profile.reliability is ReliabilityPolicy.RELIABLE
            latched = info.qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL
            self.offered[name] = (info.topic_type, reliable, latched)

    def take(self, _: Batch) -> None:
        """After a batch: hears all of it, then does what the script says."""
        self.batches += 1
        self._until(lambda: self.clocks == self.batches * TICKS_PER_BATCH)
        if self.batches == RESET:
            future = self.resetter.call_async(Trigger.Request())
            self._until(future.done)
            self.answer = future.result()
        if self.batches in SCRIPT:
            self._command(SCRIPT[self.batches])

    def _command(self, twist: Twist) -> None:
        """Sends a command among others that must be ignored, in components that must be too."""
        before = len(self.taken)
        for linear, angular in ((np.nan, 1.0), (1.0, np.inf), (twist.linear, twist.angular)):
            linear_, angular_ = Vector3(x=linear, y=7.0, z=7.0), Vector3(x=7.0, y=7.0, z=angular)
            self.sender.publish(TwistMessage(linear=linear_, angular=angular_))
        self._until(lambda: len(self.taken) > before)

    def _note(self, name: str) -> Callable[[bytes], None]:
        def note(data: bytes) -> None:
            self.heard.append((name, data))
            self.clocks += name == "/clock"

        return note

    def _until(self, condition: Any) -> None:  # noqa: ANN401 - a predicate
        assert spin_until(self.bridge.executor, condition, PATIENCE)


@dataclass(frozen=True)
class Drive:
    """What a run sent, and what it should have sent."""

    listener: Listener
    result: RunResult
    progress: list[RunResult]
    paced: list[float]
    recording: Path
    twin: Twin
    due: list[tuple[int, Topic, Expected]]


@pytest.fixture(scope="module", params=BASE)  # those whose rates it knows
def drive(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Drive:
    folder, listener = tmp_path_factory.mktemp("oracle"), Listener()
    robot = str(request.param)
    spec = staged_rover(robot, folder)
    run = Run.of(
        terrain="flat",
        robot=str(spec.folder),
        driver="cmd_vel",
        duration=BATCHES * TICKS_PER_BATCH * TICK_NS / 1e9,
        lidar_beams=BEAMS,
        actors=(PERSON,),
    )
    options = RosOptions(
        log_dir=folder,
        host_metrics=robot == "leo",
        record=folder / "drive.mcap",
        cmd_vel="twist",  # the listener's, which is sent from within this context
    )
    take, refuse = RoverOrders.command, Bridge.refuse_other_publishers

    def join(bridge: Bridge, names: tuple[str, ...]) -> None:
        refuse(bridge, names)
        listener.join(bridge)

    def note(source: RoverOrders, twist: Twist) -> None:
        listener.taken.append(twist)
        take(source, twist)

    progress: list[RunResult] = []
    paced: list[float] = []
    with pytest.MonkeyPatch.context() as patch, reserved_domain() as domain:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        patch.setattr(assembly, "_terrain_world", lambda _: stage(spec))
        patch.setattr(Bridge, "refuse_other_publishers", join)
        patch.setattr(RoverOrders, "command", note)
        patch.setattr(Pacer, "postpone", lambda _, seconds: paced.append(seconds))
        patch.setattr(Pacer, "wait_until", lambda _, time_ns: paced.append(time_ns))
        outputs = [Outputs(log_dir=folder, observers=[listener])]
        (result,) = run_through_ros(run, outputs, options, StopRequest(), progress.append)
    listener.heard.sort(key=order)
    listener.drove_s = time.monotonic() - listener.joined
    twin, due = expectations(spec, tuple(BASE).index(robot))
    assert options.record is not None
    return Drive(listener, result, progress, paced, options.record, twin, due)


def order(arrived: Arrived) -> tuple[bool, str]:
    """What is told once, before the first tick, comes when it will; all else in its order."""
    latched = TABLE[arrived[0]].latched
    return not latched, arrived[0] if latched else ""


def expectations(spec: RoverSpec, rover: int) -> tuple[Twin, list[tuple[int, Topic, Expected]]]:
    """Every message that is due in the drive, in order, with the time at which it is."""
    twin, table = Twin(spec, peopled(stage(spec))), topics()
    due = [(0, topic, topic.expect(twin)) for topic in table if not topic.rates[rover]]
    command = Twist()
    for tick in range(BATCHES * TICKS_PER_BATCH):
        batch, within = divmod(tick, TICKS_PER_BATCH)
        if batch == RESET and within == 0:
            twin.put_back()
            command = Twist()
        command = SCRIPT.get(batch, command)
        twin.tick(command)
        now = [topic for topic in table if topic.due(tick + 1, rover)]
        due += [(twin.time_ns, topic, topic.expect(twin)) for topic in now]
    return twin, due


def test_every_topic_is_offered_with_its_type_reliability_and_durability(drive: Drive) -> None:
    table = {name: (topic.kind, topic.reliable, topic.latched) for name, topic in TABLE.items()}
    assert drive.listener.offered == table


def test_every_message_arrives_once_and_in_order_samples_before_their_clock(drive: Drive) -> None:
    assert drive.result.failure is None
    assert [name for name, _ in drive.listener.heard] == [topic.name for _, topic, _ in drive.due]
    counted = {name: count.published for name, count in drive.result.topics.items()}
    assert counted == Counter(topic.name for _, topic, _ in drive.due)


def read(name: str, data: bytes) -> Any:  # noqa: ANN401 - of rclpy, or of rosbags what it cannot read
    if name in ("/tf", "/tf_static", "/height_scan/grid_map"):
        return typestore().deserialize_cdr(data, TABLE[name].kind)
    return deserialize_message(data, KINDS[name])


def test_every_field_of_every_message_is_what_mujocos_raw_state_says(drive: Drive) -> None:
    wrong: list[str] = []
    for (name, data), (time_ns, topic, expected) in zip(drive.listener.heard, drive.due, strict=True):
        message = read(name, data)
        found = differences(message, expected, topic.tolerance, name)
        wrong += [f"t = {time_ns / 1e9:.2f} s: {difference}" for difference in found]
    assert not wrong, f"{len(wrong)} fields:\n" + "\n".join(wrong[:20])


def test_the_recording_holds_what_was_heard_at_its_time(drive: Drive) -> None:
    with drive.recording.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        recorded = list(reader.iter_messages(log_time_order=False))
    kept = [entry for entry in recorded if entry[1].topic not in UNHEARD]
    kinds = {channel.topic: schema.name for schema, channel, _ in kept if schema}
    with AnyReader([drive.recording]) as bag:
        qos = {c.topic: c.ext.offered_qos_profiles[0] for c in bag.connections}  # type: ignore[union-attr]
    latched, *_ = [qos.pop(topic, None) for topic in UNHEARD]
    assert latched is not None
    assert (latched.depth, latched.durability.name) == (1, "TRANSIENT_LOCAL")
    assert [(c.topic, m.data) for _, c, m in kept] == drive.listener.heard
    times = [time_ns for time_ns, _, _ in drive.due]
    assert [m.log_time for *_, m in kept] == [m.publish_time for *_, m in kept] == times
    assert kinds == {name: topic.kind for name, topic in TABLE.items()}
    assert {topic: profile.reliability.name == "RELIABLE" for topic, profile in qos.items()} == {
        name: topic.reliable for name, topic in TABLE.items()
    }
    others = {t: (q.history.name, q.depth, q.durability.name) for t, q in qos.items()}
    assert others == {
        name: ("KEEP_LAST", topic.depth, "TRANSIENT_LOCAL" if topic.latched else "VOLATILE")
        for name, topic in TABLE.items()
    }


def test_commands_are_the_finite_ones_and_the_service_says_when(drive: Drive) -> None:
    assert drive.listener.taken == list(SCRIPT.values())
    at = RESET * TICKS_PER_BATCH * TICK_NS / 1e9
    assert drive.listener.answer.success
    assert drive.listener.answer.message == f"the rover goes back to its start at t = {at:.2f} s"
    assert drive.result.truth.resets == 1


def test_the_run_tells_how_far_it_is_and_keeps_its_pace(drive: Drive) -> None:
    result, hosts = drive.result, drive.twin.rover.name == "leo"
    seconds = [0.05 * (batch + 1) for batch in range(BATCHES)]
    shown = [
        round(progress.simulated_s / 0.05) for progress in drive.progress
    ]  # as often as one can see
    assert shown == sorted(set(shown))
    first, last = drive.progress[0], drive.progress[-1]
    assert last.simulated_s == pytest.approx(seconds[-1])
    assert last.truth.path_length == pytest.approx(drive.twin.path_length)
    assert (last.messages, last.wall_s, last.truth) == (len(drive.due), result.wall_s, result.truth)
    assert first.messages == sum(time_ns <= first.simulated_s * 1e9 for time_ns, *_ in drive.due)
    assert 0.0 < result.wall_s < drive.listener.drove_s, "what came before the drive does not count"
    assert result.mode == f"ROS 2, {'hosted metrics_node' if hosts else 'no metrics_node'}"
    assert (result.lost, result.rows, result.segments) == (0, *((4, 1) if hosts else (0, None)))
    ticks = [TICK_NS * (tick + 1) for tick in range(BATCHES * TICKS_PER_BATCH)]
    assert drive.paced == [entry for time_ns in ticks for entry in (0.0, time_ns)]


def test_the_drive_shows_everything_that_a_field_can_say(drive: Drive) -> None:
    """Rest at first, each contact and none, slip of either sign, hits, misses, more than a half turn."""

    def said_by(name: str) -> list[Expected]:
        return [expected for _, topic, expected in drive.due if topic.name == name]

    values = np.array([expected["data"] for expected in said_by("/rover/truth/traversal")])
    force, rock, scrape, speed, _, *slips, roughness = values.T
    assert drive.twin.restless < 2e-3
    for signal in (force, rock, scrape):
        assert signal.min() == 0.0 < signal.max()
    for signal in (speed, *slips):
        assert signal.min() < -0.05 < 0.1 < signal.max()
    assert roughness.max() > 2 * roughness.min() > 0.0
    ranges = [[e["ranges"] for e in said_by(name)] for name in ("/scan", "/lidar2d/scan")]
    ranges.append([e["data"].values for e in said_by("/depth/image")])
    for some in ranges:
        assert {-np.inf, np.inf} < set(np.concatenate(some).ravel())
    points = np.concatenate([e["data"].values for e in said_by("/lidar3d/points")])
    assert set(points[:, 3]) == {EARTH, THING}
    assert set(points[:, 4]) == {0.0, 1.0, 2.0}
    turned = [e["pose"]["pose"]["orientation"]["z"] for _, t, e in drive.due if "wheels" in t.name]
    assert min(turned) < -0.95 < 0.95 < max(turned)  # through the half turn
