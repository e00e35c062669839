import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import PoseArray, Twist
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Float64

from harness.config import EpisodeConfig
from harness.errors import RunFailed, UsageError
from harness.ros.network import reserved_domain
from harness.testing import Trial

EXAMPLES = Path(__file__).parents[3] / "examples"


class Echo(Node):  # type: ignore[misc]  # rclpy has no types for mypy
    """Answers each scan and each timer call with the time; a slow and chatty node."""

    def __init__(self) -> None:
        super().__init__("echo")
        self.scans: list[int] = []
        self._answer = self.create_publisher(Float64, "answer", 10)
        self._calls = self.create_publisher(Float64, "calls", 10)
        self.create_subscription(LaserScan, "scan", self._on_scan, 10)
        self.create_timer(0.1, lambda: self._say(self._calls))

    def _on_scan(self, scan: LaserScan) -> None:
        self.scans.append(len(scan.ranges))
        self._say(self._answer)

    def _say(self, publisher: object) -> None:
        seconds = self.get_clock().now().nanoseconds / 1e9
        publisher.publish(Float64(data=seconds))  # type: ignore[attr-defined]  # rclpy


class WallClock(Node):  # type: ignore[misc]  # rclpy has no types for mypy
    def __init__(self) -> None:
        super().__init__("wall_clock", use_global_arguments=False)


@contextmanager
def trial(*faults: str, **changes: object) -> Iterator[Trial]:
    values: dict[str, object] = {"terrain": "flat", "driver": "cmd_vel", "lidar_beams": 8}
    values |= {"duration": 5.0, "faults": faults}
    with Trial(EpisodeConfig(**{**values, **changes})) as made:  # type: ignore[arg-type]  # a table
        yield made


def test_every_message_and_timer_is_handled_before_a_step_returns() -> None:
    with trial() as one:
        node = one.host(Echo)
        answers, calls = one.collect(Float64, "answer"), one.collect(Float64, "calls")
        for step in range(1, 11):
            one.step(0.1)
            assert one.time == pytest.approx(0.1 * step)
            assert len(node.scans) == len(answers) == 2 * step
            assert len(calls) == step
        assert calls.times == pytest.approx([0.1 * n for n in range(1, 11)])
        assert answers.times == pytest.approx([0.05 * n for n in range(1, 21)])


def test_same_trial_twice_hears_the_same_at_the_same_time() -> None:
    def heard() -> list[tuple[float, float]]:
        with trial("scan:dropout=0.5") as one:
            one.host(Echo)
            answers = one.collect(Float64, "answer")
            one.step(2.0)
            return [(m.data, t) for m, t in zip(answers.messages, answers.times, strict=True)]

    first = heard()
    assert 10 < len(first) < 30
    assert heard() == first


def test_topics_of_the_rover_can_be_collected_and_show_the_faults() -> None:
    with trial("imu:dropout@0.5", "pose:duplicate=2", "pose:empty@0.8", "scan:beams=3@0.5") as one:
        imus, poses = one.collect(Imu, "imu/data"), one.collect(PoseArray, "rover/pose_array")
        node = one.host(Echo)
        one.step(1.0)
        assert len(imus) == 9
        assert len(poses) == 100
        assert [len(p.poses) for p in poses.messages] == [1] * 78 + [0] * 22
        assert node.scans == [8] * 9 + [3] * 11


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        ("clock:jump=5@0.5", [0.49, 5.5]),
        ("clock:reset@0.5", [0.49, 0.01]),
        ("clock:freeze@0.5+0.2", [0.49, 0.49]),
    ],
)
def test_clock_faults_reach_the_node_and_nothing_hangs(fault: str, expected: list[float]) -> None:
    with trial(fault) as one:
        clock = one.collect(Clock, "/clock")
        node = one.host(Echo)
        one.step(1.0)
        told = [m.clock.sec + m.clock.nanosec / 1e9 for m in clock.messages]
        assert told[48:50] == pytest.approx(expected)
        assert len(node.scans) == 20
        assert node.get_clock().now().nanoseconds / 1e9 == pytest.approx(told[-1])


def test_rover_obeys_the_test_and_then_the_node() -> None:
    class Brake(Node):  # type: ignore[misc]  # rclpy has no types for mypy
        def __init__(self) -> None:
            super().__init__("brake")
            self._command = self.create_publisher(Twist, "cmd_vel", 10)
            self.create_timer(1.5, lambda: self._command.publish(Twist()))

    with trial() as one:
        one.host(Brake)
        one.drive(0.3)
        assert one.until(lambda: one.speed > 0.25, within=1.0) < 1.0
        one.step(1.5 - one.time)
        assert one.until(lambda: abs(one.speed) < 0.01, within=0.6) > 0.05
        assert math.hypot(*one.truth.position[:2]) > 0.2
        one.reset()
        one.step(0.1)
        assert math.hypot(*one.truth.position[:2]) < 0.05
        assert one.truth.resets == 1


def test_condition_that_does_not_come_true_fails_the_test_in_simulated_time() -> None:
    with trial() as one:
        with pytest.raises(AssertionError, match=r"did not hold within 0\.2 simulated seconds"):
            one.until(lambda: False, within=0.2)
        assert one.time == pytest.approx(0.2)


def test_nothing_heard_is_an_assertion_too() -> None:
    with trial() as one, pytest.raises(AssertionError, match="nothing has been heard on /answer"):
        _ = one.collect(Float64, "answer").latest


@pytest.mark.parametrize(
    ("misuse", "message"),
    [
        (lambda one: one.step(6.0), "the episode is over after 5 s"),
        (lambda one: one.host(WallClock), "/wall_clock runs on wall time; start it with"),
        (lambda one: one.__enter__(), "rclpy is initialised already"),
    ],
)
def test_misuse_is_told_in_one_line(misuse: Callable[[Trial], None], message: str) -> None:
    with trial() as one, pytest.raises(UsageError, match=message):
        misuse(one)


def test_driving_a_rover_that_drives_itself_is_refused() -> None:
    with trial(driver="straight") as one, pytest.raises(UsageError, match='choose "cmd_vel"'):
        one.drive(0.1)


def test_invalid_fault_is_refused_before_anything_starts() -> None:
    with pytest.raises(UsageError, match="there is no sensor 'sonar'"):
        Trial(EpisodeConfig(faults=("sonar:nan",)))


def test_process_that_ends_at_once_is_told_with_its_exit_code() -> None:
    with trial() as one, pytest.raises(RunFailed, match="/absent ended at its start with exit code 7"):
        one.launch([sys.executable, "-c", "raise SystemExit(7)"], node="/absent")


def test_trial_leaves_rclpy_as_it_was_even_after_a_failure() -> None:
    def fail() -> None:
        with trial() as one:
            one.host(lambda: 1 / 0)

    with pytest.raises(ZeroDivisionError):
        fail()
    assert not rclpy.ok()


@pytest.mark.filterwarnings("ignore:Deprecated in favor of:DeprecationWarning")  # as rclpy tells it
def test_trial_goes_on_after_a_node_has_raised() -> None:
    class Touchy(Node):  # type: ignore[misc]  # rclpy has no types for mypy
        def __init__(self) -> None:
            super().__init__("touchy")
            self.scans = 0
            self.create_subscription(LaserScan, "scan", self._on_scan, 10)

        def _on_scan(self, _: LaserScan) -> None:
            self.scans += 1
            if self.scans == 2:
                raise ZeroDivisionError

    with trial() as one:
        node = one.host(Touchy)
        with pytest.raises(ZeroDivisionError):
            one.step(0.5)
        assert one.time == pytest.approx(0.1)
        one.step(0.4)
        assert one.time == pytest.approx(0.5)
        assert node.scans == 10


def test_no_two_trials_share_a_domain() -> None:
    with reserved_domain() as one, reserved_domain() as other:
        assert one != other


def test_worked_example_passes_as_a_user_runs_it(tmp_path: Path) -> None:
    copy = shutil.copytree(EXAMPLES, tmp_path / "examples", ignore=shutil.ignore_patterns("__pycache__"))
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(copy)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stdout
    assert "5 passed" in done.stdout
