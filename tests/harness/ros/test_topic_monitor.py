"""What harness.topics shows, on a clock of the test's own: rates, quality, types, who is there."""

import re
import sys

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from builtin_interfaces.msg import Time
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rich.console import Console
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu

from harness.ros.topic_monitor import WINDOW, Pace, TopicMonitor, message_class, quality
from rover_metrics.ros.parameters import BEST_EFFORT
from rover_metrics.ros.subscriptions import keep_last
from tests.support.ros import Ros, Untyped


def noted(*points: tuple[float, float]) -> Pace:
    pace = Pace()
    for now, value in points:
        pace.note(now, value)
    return pace


@pytest.mark.parametrize(
    ("points", "now", "rate"),
    [
        ([(0.0, 0.0), (1.0, 9.0), (2.0, 10.0)], 2.0, 5.0),
        ([(0.0, 0.0), (1.0, 10.0), (5.0, 30.0)], WINDOW, 6.0),  # what is WINDOW old still counts
        ([(0.0, 0.0), (1.0, 10.0), (5.0, 30.0)], WINDOW + 0.01, 5.0),
        ([(0.0, 0.0), (1.0, 10.0)], WINDOW + 0.5, None),
        ([(0.0, 50.0), (1.0, 3.0), (2.0, 5.0)], 2.0, 2.0),  # it fell: anew
        ([(1.0, 1.0), (1.0, 2.0)], 1.0, None),
        ([(1.0, 1.0)], 1.0, None),
    ],
)
def test_a_rate_is_growth_over_the_window(
    points: list[tuple[float, float]], now: float, rate: float | None
) -> None:
    assert noted(*points).rate(now) == (None if rate is None else pytest.approx(rate))


def test_an_age_is_that_of_the_last_value_and_memory_is_bounded_by_the_window() -> None:
    assert Pace().age(1.0) is None
    assert noted((1.0, 1.0), (2.0, 2.0)).age(20.0) == pytest.approx(18.0)
    pace = noted(*((count / 100.0, count) for count in range(round(1000.0 * WINDOW) + 1)))
    assert len(pace.points) <= 100.0 * WINDOW + 1


FOREIGN = ("antigravity/msg/Imu", "no_such_package/msg/Imu", "sensor_msgs/srv/Imu", "os/msg/Path")


@pytest.mark.parametrize("name", [*FOREIGN, "../msg/Imu"])
def test_a_type_name_from_the_network_imports_nothing_but_messages(name: str) -> None:
    assert message_class(name) is None
    assert "antigravity" not in sys.modules


def test_quality_shows_what_the_middleware_tells() -> None:
    untold = QoSProfile(history=HistoryPolicy.UNKNOWN, depth=0, reliability=ReliabilityPolicy.RELIABLE)
    assert quality(untold) == "reliable"
    assert quality(keep_last(10, BEST_EFFORT)) == "best effort 10"
    latched = DurabilityPolicy.TRANSIENT_LOCAL
    every = QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0, durability=latched)
    assert quality(every).endswith("transient local all")


class Scene:
    """A talker and a monitor, on a clock that the test sets."""

    def __init__(self, ros: Ros, namespace: str = "") -> None:
        self.ros, self.now, self.talker = ros, 0.0, ros.node("talker")
        self.monitor = TopicMonitor(ros.node("watcher"), namespace, now=lambda: self.now)

    def publisher(self, kind: type, topic: str, qos: object = 10, *, settled: bool = True) -> Untyped:
        """A publisher that the monitor hears, and counts at once if it is settled."""
        publisher = self.talker.create_publisher(kind, topic, qos)

        def listens() -> bool:
            if publisher.topic_name not in self.monitor.types:
                self.monitor.look_around()
            return bool(publisher.get_subscription_count())

        self.ros.until(listens)
        if settled:
            self.monitor.look_around()  # nothing new: what comes now counts
        return publisher

    def publish(self, publisher: Untyped, message: object, at: float) -> None:
        """Publishes at a time [s] and waits until the monitor has it."""
        self.now, counts = at, self.monitor.counts
        expected = counts[publisher.topic_name] + 1
        publisher.publish(message)
        self.ros.until(lambda: counts[publisher.topic_name] == expected)

    def table(self) -> dict[str, list[str]]:
        """The cells of each row, by their topic."""
        console = Console(width=200)
        with console.capture() as captured:
            console.print(self.monitor.table())
        rows = re.findall(r"^│ (/\S+) +│(.*)│$", captured.get(), re.MULTILINE)
        return {topic: [cell.strip() for cell in cells.split("│")] for topic, cells in rows}


def test_a_topic_shows_rate_age_quality_type_and_who_is_there(ros: Ros) -> None:
    scene = Scene(ros)
    scene.talker.create_subscription(Imu, "imu/data", lambda _: None, 10)
    imu = scene.publisher(Imu, "imu/data")
    ros.until(lambda: imu.get_subscription_count() == 2)
    for tick in range(11):
        scene.publish(imu, Imu(), at=tick * 0.05)
    scene.publisher(Imu, "/imu/data")  # another, that says nothing
    scene.now += 1.5
    type_name, rate, simulated, age, qos, *counts = scene.table()["/imu/data"]
    assert type_name == "sensor_msgs/msg/Imu"
    assert (rate, simulated, age) == ("20.0", "-", "1.50")
    assert qos.startswith("reliable")
    assert counts == ["2", "1"]


def test_with_a_simulations_clock_the_rate_is_also_given_in_its_time(ros: Ros) -> None:
    scene = Scene(ros)
    clock = scene.publisher(Clock, "/clock")
    for tick in range(6):
        sec, nanosec = divmod(tick * 500_000_000, 10**9)
        scene.publish(clock, Clock(clock=Time(sec=sec, nanosec=nanosec)), at=tick * 0.1)
    assert scene.table()["/clock"][1:3] == ["10.0", "2.0"]
    assert scene.monitor.table().caption == "/clock runs at 5.0x real time"


@pytest.mark.parametrize("latched", [False, True])
def test_a_rate_begins_after_the_heap_of_finding_topics_and_is_sure_in_three_seconds(
    ros: Ros, latched: bool
) -> None:
    scene = Scene(ros)
    imu = scene.publisher(Imu, "imu/data", keep_last(10, latched=latched), settled=False)
    pace = scene.monitor.paces["/imu/data"]
    for _ in range(10):  # half a second's, at once
        scene.publish(imu, Imu(), at=0.0)
    scene.monitor.look_around()
    for number in range(61):  # at 20 Hz
        scene.publish(imu, Imu(), at=0.5 + number * 0.05)
        assert pace.rate(scene.now) == (pytest.approx(20.0) if number >= 10 else None)
        unsure = [] if latched or number == 60 else ["/imu/data"]  # what is latched is sent once
        assert scene.monitor.too_short() == unsure
    scene.now += 9.0
    assert scene.monitor.too_short() == ([] if latched else ["/imu/data"])


@pytest.mark.parametrize(
    ("namespace", "shown"),
    [("", ["/clock", "/rover1/imu", "/rover11/imu"]), ("rover1", ["/clock", "/rover1/imu"])],
)
def test_topics_are_listed_by_name_and_a_namespace_leaves_out_all_others_but_the_clock(
    ros: Ros, namespace: str, shown: list[str]
) -> None:
    scene = Scene(ros, namespace)
    kinds = {"/rover11/imu": Imu, "/clock": Clock, "/rover1/imu": Imu}
    made = {name: scene.talker.create_publisher(kinds[name], name, 10) for name in kinds}
    for name in shown:
        scene.publisher(kinds[name], name, keep_last(1, BEST_EFFORT))
    assert list(scene.table()) == shown
    listened = [name for name, publisher in made.items() if publisher.get_subscription_count()]
    assert sorted(listened) == shown
