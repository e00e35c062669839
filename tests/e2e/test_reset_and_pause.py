"""The services of a run, called over real DDS by a node of its own context while the run goes on."""

import csv
import math
import signal
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.support.waiting import PATIENCE

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from std_srvs.srv import SetBool, Trigger

from harness.base.interrupt import StopRequest
from harness.episode.batch import Batch
from harness.episode.loop import Observer
from harness.episode.result import Outputs, RunResult
from harness.episode.stream import AHEAD
from harness.ros import session
from harness.ros.context import make_executor, spin_until
from harness.ros.session import run_through_ros
from harness.samples import Odometry, Pose
from harness.spec.ros import RosOptions
from harness.spec.run import Run


class Caller:
    """Calls services of the node `harness`."""

    def __init__(self) -> None:
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node("caller", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self.clients = {
            "reset": self._node.create_client(Trigger, "harness/reset"),
            "pause": self._node.create_client(SetBool, "harness/pause"),
            "get_parameters": self._node.create_client(GetParameters, "metrics_node/get_parameters"),
        }

    def ask(self, service: str, request: object) -> Any:  # noqa: ANN401 - a future
        """Sends a request as soon as the service is there."""
        client = self.clients[service]
        assert client.wait_for_service(PATIENCE)
        return client.call_async(request)

    def has_heard(self, future: Any) -> bool:  # noqa: ANN401 - a future
        """Whether the answer has come."""
        self._executor.spin_once(timeout_sec=0.0)
        return bool(future.done())

    def call(self, service: str, request: object) -> Any:  # noqa: ANN401 - a response
        """The answer to a request."""
        future = self.ask(service, request)
        self._executor.spin_until_future_complete(future, PATIENCE)
        return future.result()

    def close(self) -> None:
        self._executor.shutdown()
        self._context.try_shutdown()


@pytest.fixture
def caller(ros_domain: int) -> Iterator[Caller]:  # noqa: ARG001 - the domain that both speak in
    caller = Caller()
    yield caller
    caller.close()


def drive(folder: Path, run: Run, stop: StopRequest, observers: tuple[Observer, ...] = ()) -> RunResult:
    outputs = [Outputs(log_dir=folder, observers=observers)]
    (result,) = run_through_ros(run, outputs, RosOptions(log_dir=folder), stop)
    return result


def test_a_reset_is_a_jump_of_the_pose_and_of_nothing_else(
    caller: Caller, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    executors: list[Executor] = []

    def remembered(*args: Any, **options: Any) -> Executor:  # noqa: ANN401 - as make_executor
        executors.append(make_executor(*args, **options))
        return executors[0]

    monkeypatch.setattr(session, "make_executor", remembered)
    run = Run.of(terrain="flat", driver="straight", duration=6.0)
    batches: list[Batch] = []
    answers: list[Any] = []

    class Watcher:
        def take(self, batch: Batch) -> None:
            batches.append(batch)
            if len(batches) == 50:
                future = caller.ask("reset", Trigger.Request())
                assert spin_until(executors[0], lambda: caller.has_heard(future), PATIENCE)
                answers.append(future.result())

    result = drive(tmp_path, run, StopRequest(), (Watcher(),))
    assert result.failure is None
    assert answers[0].success
    first_after = next(i for i, batch in enumerate(batches) if batch.truth.resets)
    assert first_after == 50 + AHEAD
    begin_s = first_after * 0.05
    assert answers[0].message == f"the rover goes back to its start at t = {begin_s:.2f} s"

    ticks = [tick for batch in batches for tick in batch.ticks]
    assert [tick.stamp_ns for tick in ticks] == [10_000_000 * n for n in range(1, 601)]
    poses = [s for tick in ticks for s in tick.samples if isinstance(s, Pose)]
    (jump,) = (i for i, (a, b) in enumerate(pairwise(poses)) if math.dist(a.position, b.position) > 0.1)
    assert poses[jump].stamp_ns / 1e9 == pytest.approx(begin_s, abs=0.021)
    assert math.dist(poses[jump + 1].position, poses[0].position) < 0.01
    odometry = [s for tick in ticks for s in tick.samples if isinstance(s, Odometry)]
    assert all(abs(b.x - a.x) < 0.03 for a, b in pairwise(odometry))

    assert result.truth.resets == 1
    assert result.truth.path_length == pytest.approx(6.0 * 0.3, rel=0.1)
    assert result.log_path is not None
    with result.log_path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["Timestamp"]) for row in rows] == [1, 2, 3, 4, 5, 6]
    distance = float(rows[-1]["Distance Traveled"])
    assert distance == pytest.approx(result.truth.path_length, rel=0.05)
    assert result.lost == 0


def test_a_paused_run_stands_still_answers_goes_on_and_can_be_stopped(
    caller: Caller, tmp_path: Path
) -> None:
    stop = StopRequest()

    def pause(state: bool) -> str:
        response = caller.call("pause", SetBool.Request(data=state))
        assert response.success
        return str(response.message)

    def meddle() -> list[str]:
        said = [pause(True), pause(True)]
        names = GetParameters.Request(names=["collision_threshold"])
        assert caller.call("get_parameters", names).values[0].double_value == 0.2
        said += [pause(False), pause(True)]
        stop.signal = signal.SIGINT  # as Ctrl-C leaves it
        return said

    with ThreadPoolExecutor() as threads:
        meddling = threads.submit(meddle)
        began = time.monotonic()
        result = drive(tmp_path, Run.of(terrain="flat", driver="spin", duration=3600.0), stop)
        took = time.monotonic() - began
        first, again, on, _ = meddling.result()
    paused_at = first.removeprefix("paused at ")
    assert again == f"paused already at {paused_at}"
    assert on == f"goes on at {paused_at}"
    assert result.interrupted == "SIGINT"
    assert result.failure is None
    assert 0.0 < result.paused_s < took - result.wall_s
    assert result.rows == int(result.simulated_s)
