"""How a node's program ends when its executor does what a test says."""

import os
from contextlib import suppress
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

import rclpy
import rclpy.executors
from rclpy.context import Context
from rclpy.task import Future

from rover_metrics.metrics_node import MetricsNode
from rover_metrics.ros import program
from tests.support.shared_memory import shared_memory

Patch = pytest.MonkeyPatch


class Stage:
    """ROS and a node, as far as a program sees them; what happens is written down."""

    def __init__(self, monkeypatch: Patch) -> None:
        self.events: list[object] = []
        self.ros_is_up = True
        self.errors: dict[str, BaseException] = {}
        monkeypatch.setattr(rclpy, "init", lambda *, args: self.happen("init", args))
        monkeypatch.setattr(rclpy, "try_shutdown", lambda: self.happen("shutdown ROS"))
        monkeypatch.setattr(rclpy, "ok", self.ok)
        monkeypatch.setattr(program, "SingleThreadedExecutor", lambda: self.happen("standard executor"))
        monkeypatch.setattr(program, "EventsExecutor", lambda: self.happen("events executor"))
        self.in_lock_step = False
        self.lock_steps: list[bool] = []  # after each spin; then ROS is shut down

    def happen(self, what: str, *details: object) -> Any:  # noqa: ANN401 - the node too
        self.events.append((what, *details) if details else what)
        if what in self.errors:
            raise self.errors[what]
        return self

    @property
    def context(self) -> "Stage":
        return self

    def ok(self) -> bool:
        return self.ros_is_up

    def make_node(self) -> Any:  # noqa: ANN401
        return self.happen("make node")

    def add_node(self, node: object) -> None:
        assert node is self
        self.happen("add node")

    def spin_once(self, timeout_sec: float) -> None:
        assert timeout_sec > 0.0
        gives_way = hasattr(os, "SCHED_BATCH") and os.sched_getscheduler(0) == os.SCHED_BATCH
        self.happen("spin giving way" if gives_way else "spin")
        self.ros_is_up = self.ros_is_up and bool(self.lock_steps)
        self.in_lock_step = self.lock_steps.pop(0) if self.lock_steps else False

    def spin_until_future_complete(self, future: Future, timeout_sec: float) -> None:
        assert not future.done()
        self.spin_once(timeout_sec)

    def begin_spin(self) -> None:
        self.happen("begin spin")

    def __enter__(self) -> "Stage":
        return self

    def __exit__(self, *_: object) -> None:
        self.happen("shutdown executor")

    def fail(self, reason: str) -> None:
        self.happen("fail", reason)

    def destroy_node(self) -> None:
        self.happen("destroy node")

    def run(self) -> int:
        return program.run_node("metrics_node", self.make_node, ["--ros-args"])


GIVING_WAY = "spin giving way" if hasattr(os, "SCHED_BATCH") else "spin"
UP = [("init", ["--ros-args"])]
SPUN = ["make node", "standard executor", "begin spin", "add node", "spin"]
DOWN = ["destroy node", "shutdown executor", "shutdown ROS"]


def test_while_a_simulator_waits_the_faster_executor_spins_the_node(monkeypatch: Patch) -> None:
    stage = Stage(monkeypatch)
    stage.lock_steps = [False, True, True, False]
    assert stage.run() == 0
    fast = ["shutdown executor", "events executor", "begin spin", "add node", *[GIVING_WAY] * 2]
    standard = ["shutdown executor", "standard executor", "begin spin", "add node", "spin"]
    assert stage.events == [*UP, *SPUN, "spin", *fast, *standard, *DOWN]


@pytest.mark.parametrize("error", [RuntimeError("context"), AttributeError("handle")])
@pytest.mark.parametrize("where", ["make node", "spin"])
@pytest.mark.parametrize("ros_is_up", [True, False])
def test_an_error_of_rclpy_after_a_signal_is_a_clean_end(
    monkeypatch: Patch, error: Exception, where: str, ros_is_up: bool
) -> None:
    stage = Stage(monkeypatch)
    stage.errors[where], stage.ros_is_up = error, ros_is_up
    if ros_is_up:
        with pytest.raises(type(error)):
            stage.run()
    else:
        assert stage.run() == 0
    failed = ("fail", f"{type(error).__name__}: {error}") in stage.events
    assert failed is (ros_is_up and where == "spin")
    assert stage.events[-1] == DOWN[-1]


def test_a_wait_that_was_woken_before_ros_is_down_ends(ros_domain: int, monkeypatch: Patch) -> None:
    # rclpy answers a signal in this order; whoever is quick finds ROS up, and waits once more.
    wait_set, waits, context = rclpy.executors._rclpy.WaitSet, list[int](), Context()

    def wait(self: Any, timeout_ns: int) -> None:  # noqa: ANN401 - rclpy's
        waits.append(timeout_ns)
        with context.handle:
            context.handle.shutdown()
        wait_of_rclpy(self, timeout_ns)

    wait_of_rclpy = wait_set.wait
    assert ros_domain >= 0
    rclpy.init(args=[], context=context)
    executor = rclpy.executors.SingleThreadedExecutor(context=context)
    executor.add_node(rclpy.create_node("waiter", context=context))
    executor.spin_once(timeout_sec=0.0)  # that a node came wakes it, too
    monkeypatch.setattr(wait_set, "wait", wait)
    with suppress(rclpy.executors.ExternalShutdownException):
        program.spin(executor)
    context._logging_fini()  # as its own shutdown does: else no later one sets levels of loggers
    assert len(waits) == 1


@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("step", ["create_service", "setup_subscribers"])  # of rclpy's and of our own
def test_a_signal_while_a_node_is_made_leaves_nothing_of_dds(step: str, monkeypatch: Patch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(MetricsNode, step, interrupted)
    before = shared_memory("self")
    assert program.run_node("metrics_node", MetricsNode, []) == 0
    assert shared_memory("self") <= before
