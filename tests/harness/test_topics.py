"""harness.topics: its rates with a clock of the test's own, its table over real DDS, its ends."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rich.console import Console

from harness.topics import main
from tests.support.complaint import complaint

TIMEOUT = 30.0  # [s]; reached only when a test fails
Untyped = Any  # rclpy has no types
COMMAND = [sys.executable, "-m", "harness.topics"]


@pytest.mark.parametrize(
    "name",
    [
        "antigravity/msg/Imu",
        "no_such_package/msg/Imu",
        "sensor_msgs/srv/Imu",
        "../msg/Imu",
        "os/msg/Path",
    ],
)
def test_a_type_name_from_the_network_imports_nothing_but_messages(name: str) -> None:
    topic_monitor = pytest.importorskip("harness.ros.topic_monitor", exc_type=ImportError)
    assert topic_monitor.message_class(name) is None
    assert "antigravity" not in sys.modules


def profile(
    reliability: str, durability: str = "VOLATILE", history: str = "UNKNOWN", depth: int = 0
) -> SimpleNamespace:
    named = {"reliability": reliability, "durability": durability, "history": history}
    return SimpleNamespace(depth=depth, **{k: SimpleNamespace(name=v) for k, v in named.items()})


@pytest.mark.parametrize(
    ("announced", "shown"),
    [
        (profile("RELIABLE"), "reliable"),
        (profile("BEST_EFFORT", history="KEEP_LAST", depth=10), "best effort 10"),
        (profile("RELIABLE", "TRANSIENT_LOCAL", "KEEP_ALL"), "reliable transient local all"),
    ],
)
def test_quality_shows_what_the_middleware_tells(announced: object, shown: str) -> None:
    topic_monitor = pytest.importorskip("harness.ros.topic_monitor", exc_type=ImportError)
    assert topic_monitor.quality(announced) == shown


@pytest.mark.parametrize("seconds", ["0", "-1", "nan", "inf", "soon"])
def test_seconds_that_make_no_sense_are_told_in_one_line(
    seconds: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert f"'{seconds}' is not valid" in complaint(main, [f"--seconds={seconds}"], capsys)


def test_without_ros_the_command_says_so_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "rclpy.py").write_text("raise ImportError(\"No module named 'rclpy'\")\n")
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        COMMAND,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )
    assert run.returncode == 2
    assert run.stderr.startswith("harness.topics: ROS 2 is not importable (No module named 'rclpy')")
    assert run.stderr.count("\n") == 1


class Scene:
    """A talker and a monitor in one process, on a clock that the test sets."""

    def __init__(self, at_end: ExitStack, namespace: str = "") -> None:
        import rclpy  # noqa: PLC0415 - most of this file needs no ROS
        from rclpy.executors import SingleThreadedExecutor  # noqa: PLC0415

        from harness.ros.topic_monitor import TopicMonitor  # noqa: PLC0415

        self.now = 0.0
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        at_end.callback(self.context.try_shutdown)
        self.executor: Untyped = SingleThreadedExecutor(context=self.context)
        at_end.callback(self.executor.shutdown)
        self.talker: Untyped = rclpy.create_node("talker", context=self.context)
        watcher: Untyped = rclpy.create_node("watcher", context=self.context)
        self.monitor = TopicMonitor(watcher, namespace, now=lambda: self.now)
        for node in (self.talker, watcher):
            at_end.callback(node.destroy_node)
            self.executor.add_node(node)

    def publisher(self, kind: type, topic: str, qos: object = 10, *, settled: bool = True) -> Untyped:
        """A publisher that the monitor hears, and counts at once if it is settled."""
        publisher = self.talker.create_publisher(kind, topic, qos)

        def listens() -> bool:
            if publisher.topic_name not in self.monitor.types:
                self.monitor.look_around()
            return bool(publisher.get_subscription_count())

        self.spin_until(listens)
        if settled:
            self.monitor.look_around()  # nothing new: what comes now counts
        return publisher

    def spin_until(self, condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + TIMEOUT
        while not condition():
            assert time.monotonic() < deadline, "timed out"
            self.executor.spin_once(timeout_sec=0.02)

    def publish(self, publisher: Untyped, message: object, at: float) -> None:
        """Publishes at a time [s] and waits until the monitor has it."""
        self.now, counts = at, self.monitor.counts
        expected = counts[publisher.topic_name] + 1
        publisher.publish(message)
        self.spin_until(lambda: counts[publisher.topic_name] == expected)

    def cells(self, topic: str) -> list[str]:
        """The table's row of a topic."""
        console = Console(width=200)
        with console.capture() as captured:
            console.print(self.monitor.table())
        (row,) = [line for line in captured.get().splitlines() if line.startswith(f"│ {topic} ")]
        return [cell.strip() for cell in row.strip("│ ").split("│")]


@pytest.fixture
def scene(ros_domain: int) -> Iterator[Scene]:  # noqa: ARG001 - sets the environment
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    with ExitStack() as at_end:
        yield Scene(at_end)


def test_a_topic_shows_rate_age_quality_type_and_who_is_there(scene: Scene) -> None:
    from sensor_msgs.msg import Imu  # noqa: PLC0415

    scene.talker.create_subscription(Imu, "imu/data", lambda _: None, 10)
    imu = scene.publisher(Imu, "imu/data")
    scene.spin_until(lambda: imu.get_subscription_count() == 2)
    for tick in range(11):
        scene.publish(imu, Imu(), at=tick * 0.05)
    scene.publisher(Imu, "/imu/data")  # another, that says nothing
    scene.now += 1.5
    type_name, rate, simulated, age, qos, *counts = scene.cells("/imu/data")[1:]
    assert type_name == "sensor_msgs/msg/Imu"
    assert (rate, simulated, age) == ("20.0", "-", "1.50")
    assert qos.startswith("reliable")
    assert counts == ["2", "1"]


def test_with_a_simulations_clock_the_rate_is_also_given_in_its_time(scene: Scene) -> None:
    from builtin_interfaces.msg import Time  # noqa: PLC0415
    from rosgraph_msgs.msg import Clock  # noqa: PLC0415

    clock = scene.publisher(Clock, "/clock")
    for tick in range(6):
        sec, nanosec = divmod(tick * 500_000_000, 10**9)
        scene.publish(clock, Clock(clock=Time(sec=sec, nanosec=nanosec)), at=tick * 0.1)
    assert scene.cells("/clock")[2:4] == ["10.0", "2.0"]
    assert scene.monitor.table().caption == "/clock runs at 5.0x real time"
    assert scene.monitor.table().title == "1 topics"


@pytest.mark.parametrize("latched", [False, True])
def test_a_rate_begins_after_the_heap_of_finding_topics_and_is_sure_in_three_seconds(
    scene: Scene, latched: bool
) -> None:
    from sensor_msgs.msg import Imu  # noqa: PLC0415

    from rover_metrics.ros.subscriptions import keep_last  # noqa: PLC0415

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


@pytest.mark.usefixtures("ros_domain")
def test_a_short_look_at_nothing_says_that_it_was_short(capfd: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    assert main(["--seconds", "0.01"]) == 0
    assert "no topics in so short a look; --seconds 8 is enough" in capfd.readouterr().out


@pytest.mark.parametrize(
    ("namespace", "shown"),
    [("", ["/clock", "/rover1/imu", "/rover11/imu"]), ("rover1", ["/clock", "/rover1/imu"])],
)
def test_topics_are_listed_by_name_and_a_namespace_leaves_out_all_others_but_the_clock(
    ros_domain: int,  # noqa: ARG001 - sets the environment
    namespace: str,
    shown: list[str],
) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    from rosgraph_msgs.msg import Clock  # noqa: PLC0415
    from sensor_msgs.msg import Imu  # noqa: PLC0415

    from rover_metrics.ros.parameters import BEST_EFFORT  # noqa: PLC0415
    from rover_metrics.ros.subscriptions import keep_last  # noqa: PLC0415

    with ExitStack() as at_end:
        scene = Scene(at_end, namespace)
        kinds = {"/rover11/imu": Imu, "/clock": Clock, "/rover1/imu": Imu}
        made = {name: scene.talker.create_publisher(kinds[name], name, 10) for name in kinds}
        for name in set(shown) - {"/clock"}:
            scene.publish(scene.publisher(Imu, name, keep_last(1, BEST_EFFORT)), Imu(), at=0.0)
        scene.publisher(Clock, "/clock")
        console = Console(width=200)
        with console.capture() as captured:
            console.print(scene.monitor.table())
        assert re.findall(r"^│ (/\w+\S*)", captured.get(), re.MULTILINE) == shown
        listened = [name for name, publisher in made.items() if publisher.get_subscription_count()]
        assert sorted(listened) == shown


def test_ctrl_c_ends_the_command_with_its_table(scene: Scene) -> None:
    from sensor_msgs.msg import Imu  # noqa: PLC0415

    imu = scene.talker.create_publisher(Imu, "a/imu", 10)
    other = scene.talker.create_publisher(Imu, "b/imu", 10)
    words = [*COMMAND, "--namespace", "a"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as command:
        try:
            scene.spin_until(lambda: imu.get_subscription_count() == 1)
            command.send_signal(signal.SIGINT)
            out, err = command.communicate(timeout=TIMEOUT)
        finally:
            command.kill()
    assert (command.returncode, err) == (0, "")
    assert "/a/imu" in out
    assert ("/b/imu" in out, other.get_subscription_count()) == (False, 0)
