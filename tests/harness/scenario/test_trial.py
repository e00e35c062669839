"""Runs of scenarios through ROS: what nodes and topics do is judged, told and kept."""

import itertools
import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import Twist
from rclpy.node import Node
from rosbags.highlevel import AnyReader
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool

from harness.base.errors import RunFailed, UsageError
from harness.episode.batch import Batch
from harness.episode.episode import Episode
from harness.samples import Imu
from harness.scenario.attempt import attempt
from harness.scenario.bound import Bound
from harness.scenario.trial import ScenarioTrial
from harness.scenario.verdict import Attempt, reasons_of
from rover_metrics.ros.parameters import BEST_EFFORT
from rover_metrics.ros.subscriptions import keep_last
from tests.harness.scenario.conftest import MakeCases

ROOT = Path(__file__).parents[3]
FAST = "driver: cmd_vel\nlidar_beams: 8\n"


class Brake(Node):  # type: ignore[misc]  # rclpy has no types for mypy
    """Drives on each scan, 30 ms after it, stops after 1 s, and then tells so for the first time."""

    speed = 0.4  # [m/s]

    def __init__(self) -> None:
        super().__init__("brake")
        self._waits = 0
        self._done: Any = None
        self._command = self.create_publisher(Twist, "cmd_vel", 10)
        self._ready = self.create_publisher(Bool, "ready", 10)
        self._also = self.create_publisher(Bool, "ready", keep_last(10, BEST_EFFORT))
        self.create_subscription(LaserScan, "scan", self._on_scan, 10)
        self.create_timer(0.01, self._on_time)

    def _on_scan(self, _: LaserScan) -> None:
        self._waits = 4  # the timer is called once on the scan's own tick

    def _on_time(self) -> None:
        now = self.get_clock().now().nanoseconds / 1e9
        if now == 0.01:
            self._ready.publish(Bool(data=True))
            self._also.publish(Bool(data=True))
        self._waits -= 1
        if self._waits:
            return
        command = Twist()
        command.linear.x = self.speed if now < 1.0 else 0.0
        self._command.publish(command)
        if not command.linear.x:
            self._done = self._done or self.create_publisher(Bool, "done", 10)
            self._done.publish(Bool(data=True))


def run(case_of: MakeCases, expect: str, more: str = "", seconds: float = 2.0) -> tuple[str, ...]:
    (case,) = case_of(expect, FAST + more)
    with ScenarioTrial(replace(case, run=case.run.alone(duration=seconds))) as trial:
        trial.host(Brake)
        found = trial.finish()
        assert trial.result.commands.taken > 0
        return found


def test_what_a_node_does_is_judged_beside_the_truth(make_cases: MakeCases) -> None:
    expect = """
  truth.speed: [{over: p95, min: 0.3}, {over: end, max: 0.02}]
  topic./cmd_vel.latency:
  - {of: /scan, min: 0.1299, max: 0.1301}
  - {of: /imu/data, window: [0.25, 2], min: 0.2299, max: 0.2301}
  topic./imu/data.count: {min: 36, max: 36}
  topic./cmd_vel.linear.x: [{min: 0.4, window: [0, 1]}, {max: 0, window: [1.02, 2]}]
  topic./cmd_vel.count: [{min: 37, max: 37}, {min: 7, max: 7, window: [0, 0.5]}]
  topic./cmd_vel.rate: {min: 20, max: 20, window: [1.2, 2]}
  topic./ready.count: {min: 2, max: 2}
  topic./scan.age: {min: 0.0999, max: 0.1001}
  topic./scan.ranges: {min: 0}
  topic./tf.transforms.transform.translation.x: {min: -5, max: 5}
  topic./tf_static.count: {min: 1, max: 1}
  topic./clock.count: [{min: 250, max: 250}, {min: 120, max: 120, window: [0, 1]}]
  topic./done.data: {min: 1}
  run.rows: {min: 2, max: 2}
  topic./scn.count: {max: 0}
  topic./odom_ground_truth.twist.twist.linear.x: {max: 0.1}
"""
    faults = "{at: 0, fault: 'scan:latency=0.1'}, {at: 0, fault: 'imu:latency=0.2'}"
    more = f"events: [{faults}, {{at: 1.5, pause: 0.3}}, {{at: 1, pause: 0.2}}]"  # in any order
    found = run(make_cases, expect, more)
    assert found[0] == "topic./scn.count: topic '/scn' does not exist; did you mean '/scan'?"
    assert found[1].startswith("topic./odom_ground_truth.twist.twist.linear.x: 0.39")
    assert len(found) == 2, found


def test_windows_are_of_simulated_time_whatever_the_clock_tells(make_cases: MakeCases) -> None:
    expect = "{topic./scan.count: {min: 9, max: 11, window: [0.5, 1]}}"
    assert run(make_cases, expect, "events: [{at: 0.3, fault: 'clock:jump=50'}]", seconds=1.0) == ()


@pytest.mark.parametrize(
    ("driver", "speed", "refused", "told"),
    [
        ("cmd_vel", math.nan, 19, "19 of 39 commands were ignored; the first: a non-finite command"),
        ("straight", 0.4, 0, "39 commands on /cmd_vel moved nothing: driver 'straight' makes its own"),
    ],
)
def test_commands_that_moved_nothing_are_told_of_beside_what_was_not_kept(
    make_cases: MakeCases,
    monkeypatch: pytest.MonkeyPatch,
    driver: str,
    speed: float,
    refused: int,
    told: str,
) -> None:
    monkeypatch.setattr(Brake, "speed", speed)
    expect = f"{{truth.path_length: {{over: end, max: 9}}, run.refused_commands: {{max: {refused}}}}}"
    (case,) = make_cases(expect, FAST)
    case = replace(case, run=case.run.alone(duration=2.0, driver=driver))
    for limit, kept in ((9.0, True), (-1.0, False)):
        bounds = case.scenario.expect | {"truth.path_length": (Bound(over="end", max=limit),)}
        scenario = case.scenario.model_copy(update={"expect": bounds})
        with ScenarioTrial(replace(case, scenario=scenario)) as trial:
            trial.host(Brake)
            *_, last = (*trial.finish(), trial.findings.unheeded)
            assert last.startswith(told)
            assert trial.findings.breaches[1:] == (() if kept else (last,))


def lines(path: Path) -> list[str]:
    return path.read_text().splitlines()


def test_a_started_metrics_node_writes_the_log_that_is_judged_and_tells_what_it_missed(
    tmp_path: Path,
) -> None:
    path = ROOT / "scenarios/logging_node.scenario.yaml"
    trial = ScenarioTrial.load(path, seed=3, robot="rover_zero4wd")
    run = trial.case.run
    assert (run.seed, run.rover.robot) == (3, "rover_zero4wd")
    expect = trial.case.scenario.expect | {"topic./rover/metrics.count": (Bound(min=2, max=2),)}
    scenario = trial.case.scenario.model_copy(update={"expect": expect})
    with ScenarioTrial(replace(trial.case, scenario=scenario, run=run.alone(duration=2.01))) as trial:
        trial.bridge.channels_of[Imu][0].published += 1  # as if one had been lost
        assert trial.finish() == ("run.lost_messages: 1 > 0, first at 2.01 s",)
        result = trial.result
        assert result.mode == "ROS 2, lock-step with /metrics_node"
        assert [result.topics[topic].received for topic in ("/scan", "/imu/data")] == [40, 40]
        page, *kept = trial.keep(tmp_path / "out", "to look at")
        (own,) = (tmp_path / "out/files").glob("*.csv")
    assert page.name == "run.html"
    (log,) = (path for path in kept if path.suffix == ".csv")
    assert log.read_bytes() == own.read_bytes()
    assert len(lines(log)) == 3
    assert "logging to" in (tmp_path / "out/launch_1.txt").read_text()
    (manifest,) = (path for path in kept if path.suffix == ".json")
    outcome = json.loads(manifest.read_text())
    assert outcome["recording"] == str(tmp_path / "out/run.mcap")
    with AnyReader([tmp_path / "out/run.mcap"]) as bag:
        counts = {each.topic: each.msgcount for each in bag.connections}
    assert (counts["/rover/metrics"], counts["/scan"], counts["/clock"]) == (2, 40, 251)


DIES = """sh -c 'while [ ! -e "{folder}/go" ]; do sleep 0.01; done; echo one; echo two; exit 3'"""


def test_a_program_that_ends_before_the_run_does_is_told_with_its_last_words(
    make_cases: MakeCases, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    launch = f"launch:\n- command: {DIES}\n  wait_for: []\n"
    (case,) = make_cases("{truth.x: {min: -1}}", FAST + launch)
    finish = ScenarioTrial.finish

    def finish_later(trial: ScenarioTrial) -> tuple[str, ...]:
        trial.step(0.5)
        (trial._files / "go").touch()
        trial._programs._running[0]._process.wait()
        return finish(trial)

    monkeypatch.setattr(ScenarioTrial, "finish", finish_later)
    done = attempt(case, tmp_path / "out")
    assert done.error is not None
    first, *said = reasons_of(done)
    assert first.endswith(" ended with exit code 3 at 0.51 s")
    assert said == lines(tmp_path / "out/launch_1.txt") == ["one", "two"]
    kept = [path.suffix for path in done.kept]
    assert kept == [".html", ".csv", ".json", ".mcap", ".txt", ""]


NODE = """import rclpy, time
from sensor_msgs.msg import LaserScan

rclpy.init()
node = rclpy.create_node("node")
node.create_subscription(LaserScan, "/scan", lambda scan: {}, 10)
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("does", "told", "said"),
    [
        ("scan.nothing", " ended with exit code 1 at 0.", "AttributeError: "),
        ("time.sleep(print('is busy', flush=True) or 1e6)", "/node stopped answering at 0.", "is busy"),
    ],
)
def test_a_node_that_does_not_go_on_is_told_with_what_it_said(
    make_cases: MakeCases,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    does: str,
    told: str,
    said: str,
) -> None:
    monkeypatch.setattr("harness.ros.remote.ANSWER_PATIENCE", 3.0)
    (tmp_path / "node.py").write_text(NODE.format(does))
    launch = f"launch: [python {tmp_path}/node.py --ros-args -p use_sim_time:=true]"
    (case,) = make_cases("{truth.x: {min: -1}}", f"{FAST}{launch}")
    first, *_, last = reasons_of(attempt(case, tmp_path / "out"))
    assert told in first
    assert last.startswith(said)


def test_what_a_program_says_that_ends_at_once_is_kept(make_cases: MakeCases, tmp_path: Path) -> None:
    launch = "launch: [sh -c 'seq 99; exit 2']"
    (case,) = make_cases("{truth.x: {min: -1}}", f"{FAST}{launch}")
    done = attempt(case, tmp_path / "out")
    assert reasons_of(done)[-1] == "99"
    (kept,) = done.kept
    assert lines(kept) == [str(number) for number in range(1, 100)]


def test_a_program_that_may_end_and_one_that_shows_no_node(
    make_cases: MakeCases, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    launch = "launch: [{command: 'true', wait_for: []}]"
    (case,) = make_cases("{topic./scan.rate: {min: 20, max: 20}}", FAST + launch)
    assert attempt(case, tmp_path).passed
    monkeypatch.setattr("harness.testing.nodes.START_PATIENCE", 0.1)
    for program, told in (
        ("sleep 1000", "launch: a node has not turned up within 0.1 s; running: none"),
        ("slep 1000", "there is no program 'slep' to launch (slep 1000)"),
    ):
        (case,) = make_cases("{truth.x: {min: -1}}", f"{FAST}launch: [{program}]")
        failed = attempt(case, tmp_path)
        assert failed == Attempt(case, error=failed.error)
        assert failed.error is not None
        assert failed.error.startswith(told)


def test_an_episode_that_ends_early_is_judged_and_a_test_that_fails_leaves_its_evidence(
    make_cases: MakeCases,
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (case,) = make_cases("{topic./scan.count: {min: 40}}", FAST)
    with ScenarioTrial(case, tmp_path / "none") as trial:
        batches = Episode.batches

        def end_early(episode: Episode) -> Iterator[Batch]:
            yield from itertools.islice(batches(episode), 10)
            raise RunFailed("the rover left the map at 0.5 s")

        monkeypatch.setattr(Episode, "batches", end_early)
        assert trial.finish() == ("run: the rover left the map at 0.5 s", "topic./scan.count: 10 < 40")
    monkeypatch.undo()
    assert not (tmp_path / "none").exists()

    def fail() -> None:
        with ScenarioTrial(case, tmp_path / "out") as trial:
            trial.step(0.1)
            trial.reset(seed=3)

    with pytest.raises(UsageError, match="a scenario's run is one episode; load another"):
        fail()
    told = [line for line in capfd.readouterr().err.splitlines() if line.startswith("kept: ")]
    assert f"kept: {tmp_path / 'out/run.html'}" in told
    assert len(told) == len(list((tmp_path / "out").iterdir())) == 4


def test_one_run_of_a_file_is_loaded(make_cases: MakeCases, tmp_path: Path) -> None:
    make_cases("{truth.x: {min: -1}}", "matrix: {robot: [leo, rover_zero4wd], difficulty: [0, 1]}")
    path = tmp_path / "two.scenario.yaml"
    told = r"has 2 runs of a seed; choose one, e.g. robot='leo', difficulty=0.0"
    with pytest.raises(UsageError, match=told):
        ScenarioTrial.load(path, robot="leo")
    with pytest.raises(UsageError, match="no run has robot=mole"):
        ScenarioTrial.load(path, robot="mole")
    assert ScenarioTrial.load(path, robot="leo", difficulty=1.0).case.name == "two[leo-1.0-0]"
