"""How a node's program ends when its executor does what a test says."""

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

import rclpy

from rover_metrics.ros import program

Patch = pytest.MonkeyPatch


class Stage:
    """ROS and a node, as far as a program sees them; what happens is written down."""

    def __init__(self, monkeypatch: Patch) -> None:
        self.events: list[object] = []
        self.ros_is_up = True
        self.errors: dict[str, BaseException] = {}
        monkeypatch.setattr(rclpy, "init", lambda *, args: self.happen("init", args))
        monkeypatch.setattr(rclpy, "try_shutdown", lambda: self.happen("shutdown ROS"))
        monkeypatch.setattr(rclpy, "ok", lambda: self.ros_is_up)
        monkeypatch.setattr(program, "SingleThreadedExecutor", lambda: self.happen("standard executor"))
        monkeypatch.setattr(program, "EventsExecutor", lambda: self.happen("events executor"))
        self.in_lock_step = False
        self.lock_steps: list[bool] = []  # after each spin; then ROS is shut down

    def happen(self, what: str, *details: object) -> Any:  # noqa: ANN401 - the node too
        self.events.append((what, *details) if details else what)
        if what in self.errors:
            raise self.errors[what]
        return self

    def make_node(self) -> Any:  # noqa: ANN401
        return self.happen("make node")

    def add_node(self, node: object) -> None:
        assert node is self
        self.happen("add node")

    def spin_once(self, timeout_sec: float | None) -> None:
        self.happen("spin" if timeout_sec is None else "spin bounded")
        self.ros_is_up = self.ros_is_up and bool(self.lock_steps)
        self.in_lock_step = self.lock_steps.pop(0) if self.lock_steps else False

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


UP = [("init", ["--ros-args"])]
SPUN = ["make node", "standard executor", "add node", "spin"]
DOWN = ["destroy node", "shutdown executor", "shutdown ROS"]


def test_while_a_simulator_waits_the_faster_executor_spins_the_node(monkeypatch: Patch) -> None:
    stage = Stage(monkeypatch)
    stage.lock_steps = [False, True, True, False]
    assert stage.run() == 0
    fast = ["shutdown executor", "events executor", "add node", *["spin bounded"] * 2]
    standard = ["shutdown executor", "standard executor", "add node", "spin"]
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
