import inspect
import math
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import PoseArray, Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rosbags.highlevel import AnyReader
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, Imu, LaserScan
from std_msgs.msg import Float64

from harness.base.errors import RunFailed, UsageError
from harness.sensors.camera import painter
from harness.spec.run import Run
from harness.testing import Trial
from tests.support.forking import ForkServer
from tests.support.waiting import PATIENCE

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
    with Trial(Run.of(**{**values, **changes})) as made:
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
            one.step(1.0)
            return [(m.data, t) for m, t in zip(answers.messages, answers.times, strict=True)]

    first = heard()
    assert 5 < len(first) < 15
    assert heard() == first


def test_topics_of_the_rover_can_be_collected_and_show_the_faults() -> None:
    with trial("imu:dropout@0.5", "pose:duplicate=2", "pose:empty@0.8", "scan:beams=3@0.5") as one:
        imus, poses = one.collect(Imu, "imu/data"), one.collect(PoseArray, "rover/pose_array")
        scans = one.collect(LaserScan, "scan", most=3)
        node = one.host(Echo)
        one.step(1.0)
        assert (len(scans), scans.latest) == (20, scans.messages[2])
        assert [m.header.stamp.nanosec for m in scans.messages] == [900000000, 950000000, 0]
        assert scans.times == pytest.approx([0.9, 0.95, 1.0])
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
        one.pause(0.02)
        assert clock.messages[-2:] == [clock.messages[-3]] * 2
        assert node.get_clock().now().nanoseconds / 1e9 == pytest.approx(told[-1])


def brake(kind: type) -> Node:
    node = rclpy.create_node("brake")
    command = node.create_publisher(kind, "cmd_vel", 10)
    node.create_timer(1.5, lambda: command.publish(kind()))
    return node


STARTED = f"""import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
{inspect.getsource(brake)}
rclpy.init()
rclpy.spin(brake(TwistStamped))
"""


@pytest.mark.parametrize("kind", [Twist, TwistStamped, None])
def test_rover_obeys_the_test_and_then_the_node(kind: type | None) -> None:
    with trial() as one:
        if kind is None:
            on_sim_time = ("--ros-args", "-p", "use_sim_time:=true")
            one.launch([sys.executable, "-c", STARTED, *on_sim_time], node="/brake")
        else:
            one.host(lambda: brake(kind))
        one.drive(0.3)
        assert one.until(lambda: one.speed > 0.25, within=1.0) < 1.0
        one.step(1.5 - one.time)
        assert one.until(lambda: abs(one.speed) < 0.01, within=0.6) > 0.05
        assert math.hypot(*one.truth.position[:2]) > 0.2
        one.reset()
        one.step(0.1)
        assert math.hypot(*one.truth.position[:2]) < 0.05
        assert one.truth.resets == 1


def test_reset_with_a_seed_is_a_new_trial_whose_time_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(painter, "multiprocessing", ForkServer())
    config = {"terrain": "rocky", "driver": "wander", "noise": "white", "lidar_beams": 8}
    config["sensors"] = "camera=small"

    def drive(one: Trial) -> tuple[list[tuple[float, ...]], list[bytes]]:
        imus = one.collect(Imu, "imu/data")
        one.step(0.7)
        images = one.collect(Image, "camera/image_raw")
        one.step(0.3)
        stamps = [m.header.stamp.sec + m.header.stamp.nanosec / 1e9 for m in imus.messages]
        assert stamps == pytest.approx(imus.times)
        forces: list[tuple[float, ...]] = [
            (a.x, a.y, a.z) for a in (m.linear_acceleration for m in imus.messages)
        ]
        return forces, [bytes(image.data) for image in images.messages]  # none without OpenGL

    with trial(seed=0, **config) as fresh:
        expected, truth = drive(fresh), fresh.truth
    with trial(seed=3, duration=1.5, **config) as one:
        one.collect(Image, "camera/image_raw")  # of a world that is no more after the reset
        one.step(0.52)
        one.reset(seed=0)
        one.step(0.03)  # the present period of 50 ms ends
        assert one.run.seed == 0
        assert drive(one) == expected
        assert one.time == pytest.approx(1.55)  # beyond the first duration
        assert one.truth == truth
        one.step(0.45)
        assert one.run.seed == 0
        with pytest.raises(UsageError, match=r"the episode is over after 2\.05 s"):
            one.step(0.1)


def test_reset_to_a_start_places_the_rover_there() -> None:
    with trial() as one:
        truths = one.collect(Odometry, "odom_ground_truth")
        one.drive(0.4)
        one.step(0.5)
        one.reset(start=(2.0, -1.0, math.pi / 2))
        one.step(0.1)
        assert one.truth.position[:2] == pytest.approx((2.0, -1.0), abs=0.01)
        assert abs(one.speed) < 0.01
        assert truths.latest.pose.pose.orientation.z == pytest.approx(math.sin(math.pi / 4), abs=1e-2)
        one.reset(seed=5)  # its start stays
        one.step(0.1)
        assert one.truth.position[:2] == pytest.approx((2.0, -1.0), abs=0.01)


def test_an_exception_leaves_recording_and_page_and_says_where(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    config = Run.of(terrain="flat", driver="cmd_vel", lidar_beams=8)

    def drive(folder: Path, *, fails: bool) -> None:
        with Trial(config, folder) as one:
            one.step(0.1)
            one.reset(seed=1)
            one.step(0.22)  # the page shows whole control periods of 50 ms
            assert not fails

    drive(tmp_path / "kept", fails=False)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(AssertionError):
        drive(tmp_path / "kept", fails=True)
    page, recording = tmp_path / "kept/trial.html", tmp_path / "kept/trial.mcap"
    assert capfd.readouterr().err == f"kept: {page}\nkept: {recording}\n"
    assert set((tmp_path / "kept").iterdir()) == {page, recording}
    assert "after 0.3 of 60.0" in re.sub(r"\s+", " ", page.read_text())
    assert re.search(r"<title>[^<]* seed 1\b", page.read_text())  # the world of now
    (tmp_path / "file").touch()
    with pytest.raises(AssertionError):
        drive(tmp_path / "file", fails=True)
    assert capfd.readouterr().err.startswith("nothing could be kept of this trial: ")


@pytest.mark.parametrize(
    ("misuse", "kind", "message"),
    [
        (lambda one: one.step(6.0), UsageError, "the episode is over after 5 s"),
        (lambda one: one.host(WallClock), UsageError, "/wall_clock runs on wall time; start it with"),
        (lambda one: one.__enter__(), UsageError, "rclpy is initialised already"),
        (lambda one: one.reset(seed=-1), UsageError, "seed -1 is not valid"),
        (lambda one: one.reset(start=(1e3, 0.0, 0.0)), UsageError, "start"),
        (lambda _: Trial(Run.of(faults=("sonar:nan",))), UsageError, "no sensor 'sonar'"),
        (
            *(lambda one: one.launch([sys.executable, "-c", "exit(7)"], node="/absent"), RunFailed),
            "ended with exit code 7",
        ),
        (lambda one: one.collect(Float64, "a").latest, AssertionError, "nothing has been heard on /a"),
        (
            *(lambda one: one.until(lambda: False, within=0.2), AssertionError),
            r"did not hold within 0\.2 simulated seconds",
        ),
    ],
)
def test_misuse_is_told_in_one_line(
    misuse: Callable[[Trial], object], kind: type[Exception], message: str
) -> None:
    with trial() as one:
        with pytest.raises(kind, match=message):
            misuse(one)
        assert one.time == pytest.approx({"the ": 5.0, "did ": 0.2}.get(message[:4], 0.0))
    with trial(driver="straight") as one, pytest.raises(UsageError, match='choose "cmd_vel"'):
        one.drive(0.1)


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


FAILING = """
import pytest
from harness.spec.run import Run
from harness.testing import Trial

@pytest.mark.parametrize("name", ["a/b"])
def test_it(name, start_trial):
    trial = start_trial(Trial(Run.of(terrain="flat", driver="cmd_vel", lidar_beams=8)))
    trial.step(0.2)
    raise AssertionError("0.2 s < 0")
"""


def test_worked_example_passes_as_a_user_runs_it(tmp_path: Path) -> None:
    copy = shutil.copytree(EXAMPLES, tmp_path / "examples", ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "test_failing.py").write_text(FAILING)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(copy)]
    command += ["--rover-artifacts", str(tmp_path / "kept")]
    command += ["--import-mode=importlib"]  # as in a clone, whose pyproject.toml says so
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert done.returncode == 1, done.stdout
    assert "1 failed, 5 passed" in done.stdout
    (folder,) = (tmp_path / "kept").iterdir()
    assert folder.name.endswith("test_failing.py_test_it_a_b")
    page, recording = folder / "trial.html", folder / "trial.mcap"
    assert f"- rover trial -\nkept: {page}\nkept: {recording}\n" in re.sub("-+", "-", done.stdout)
    assert "AssertionError: 0.2 s &lt; 0" in page.read_text()
    with AnyReader([recording]) as bag:
        counts = {c.topic: c.msgcount for c in bag.connections}
        assert bag.duration == 200_000_000 + 1  # from 0 on, when the frames are told
    assert (counts["/clock"], counts["/scan"], counts["/cmd_vel"]) == (20, 4, 0)
