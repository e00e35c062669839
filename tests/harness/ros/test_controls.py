"""~/reset and ~/pause of two rovers: what clients are answered, and how long a run is held."""

from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from std_srvs.srv import SetBool, Trigger

from harness.base.interrupt import StopRequest
from harness.ros.controls import Controls
from tests.support.ros import Ros


class Scene:
    """Two rovers of which the second's part ends before it could be reset, and a client."""

    def __init__(self, ros: Ros) -> None:
        self.ros = ros
        self.bridges = [ros.bridge(namespace="a"), ros.bridge(namespace="b")]
        resets: list[Callable[[], int | None]] = [lambda: 2_050_000_000, lambda: None]
        self.controls = Controls(list(zip(self.bridges, resets, strict=True)))
        self._asker = ros.node("client")

    def call(self, kind: Any, service: str, **fields: Any) -> Any:  # noqa: ANN401 - a future
        client = self._asker.create_client(kind, service)
        self.ros.until(client.service_is_ready)
        return client.call_async(kind.Request(**fields))

    def ask(self, kind: Any, service: str, **fields: Any) -> tuple[bool, str]:  # noqa: ANN401
        told = self.ros.ask(self._asker, kind, service, **fields)
        return told.success, told.message


@pytest.fixture
def scene(ros: Ros) -> Scene:
    return Scene(ros)


def test_each_rover_is_reset_by_itself_and_a_pause_is_of_all(scene: Scene) -> None:
    scene.bridges[0].time_ns = 1_230_000_000
    asked = [("a", False), ("b", True), ("a", True), ("a", False)]
    answers = [scene.ask(SetBool, f"/{rover}/harness/pause", data=data) for rover, data in asked]
    what = ("was not paused", "paused", "paused already", "goes on")
    assert answers == [(True, f"{words} at t = 1.23 s") for words in what]
    good, when = scene.ask(Trigger, "/a/harness/reset")
    bad, why = scene.ask(Trigger, "/b/harness/reset")
    assert (good, bad) == (True, False)
    assert when.endswith("at t = 2.05 s")
    assert "not reset at t = 1.23 s" in why


def test_a_run_is_held_while_paused_the_time_adds_up_and_a_stop_request_ends_it(scene: Scene) -> None:
    stop, held = StopRequest(), list[float]()
    assert scene.controls.hold(stop) == 0.0
    for _ in range(2):
        scene.ask(SetBool, "/a/harness/pause", data=True)
        answer = scene.call(SetBool, "/b/harness/pause", data=False)
        held.append(scene.controls.hold(stop))
        scene.ros.until(answer.done)
    assert min(held) > 0.0
    assert scene.controls.held_s == pytest.approx(sum(held))
    scene.ask(SetBool, "/a/harness/pause", data=True)
    stop.signal = 2  # type: ignore[assignment]  # of a terminal
    assert scene.controls.hold(stop) < 1.0
