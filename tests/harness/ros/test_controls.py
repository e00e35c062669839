"""~/reset and ~/pause as callbacks: what they answer, and what they make the loop do."""

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from std_srvs.srv import SetBool, Trigger

from harness.base.interrupt import StopRequest
from harness.ros import controls
from harness.ros.controls import Controls


class Rig:
    """Controls on a node and an executor that only remember; each spin takes 2 s of a false clock."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, reset: int | None = None) -> None:
        self.services: dict[str, tuple[type, Any]] = {}
        self.while_spinning: list[Any] = []
        self.timeouts: list[float] = []
        self.clock = 100.0
        monkeypatch.setattr(controls, "time", SimpleNamespace(monotonic=lambda: self.clock))
        executor = SimpleNamespace(spin_once=self._spin)
        node: Any = SimpleNamespace(create_service=self._create, time_ns=0, executor=executor)
        self.node, self.controls = node, Controls([(node, lambda: reset)])

    def _create(self, kind: type, name: str, callback: Any) -> None:  # noqa: ANN401
        self.services[name] = (kind, callback)

    def _spin(self, timeout_sec: float) -> None:
        self.timeouts.append(timeout_sec)
        self.clock += 2.0
        self.while_spinning.pop(0)()

    def ask(self, name: str, **fields: Any) -> tuple[bool, str]:  # noqa: ANN401
        kind: Any
        kind, callback = self.services[name]
        response = callback(kind.Request(**fields), kind.Response())
        assert isinstance(response, kind.Response)
        return response.success, response.message


def test_each_order_to_pause_is_answered_with_what_it_changed_and_when(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = Rig(monkeypatch)
    rig.node.time_ns = 1_230_000_000
    told = [rig.ask("~/pause", data=data) for data in (False, True, True, False)]
    what = ("was not paused", "paused", "paused already", "goes on")
    assert told == [(True, f"{words} at t = 1.23 s") for words in what]


@pytest.mark.parametrize(
    ("at_ns", "answer"),
    [
        (2_050_000_000, (True, "the rover goes back to its start at t = 2.05 s")),
        (0, (True, "the rover goes back to its start at t = 0.00 s")),
        (None, (False, "not reset at t = 1.50 s: the run ends before it would come into effect")),
    ],
)
def test_a_reset_says_when_it_happens_or_why_it_does_not(
    at_ns: int | None, answer: tuple[bool, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = Rig(monkeypatch, at_ns)
    rig.node.time_ns = 1_500_000_000
    assert rig.ask("~/reset") == answer
    assert {name: kind for name, (kind, _) in rig.services.items()} == {
        "~/reset": Trigger,
        "~/pause": SetBool,
    }


def test_a_run_is_held_while_paused_and_the_time_adds_up(monkeypatch: pytest.MonkeyPatch) -> None:
    rig, stop = Rig(monkeypatch), StopRequest()
    assert rig.controls.hold(stop) == 0.0
    for spins in (1, 2):
        rig.ask("~/pause", data=True)
        rig.while_spinning = [lambda: None] * (spins - 1) + [lambda: rig.ask("~/pause", data=False)]
        assert rig.controls.hold(stop) == 2.0 * spins
        assert rig.while_spinning == []
    assert rig.controls.held_s == 6.0
    assert 0.0 < max(rig.timeouts) <= 0.2, "a stop request waits no longer than that"


def test_a_stop_request_ends_a_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    rig, stop = Rig(monkeypatch), StopRequest()
    rig.ask("~/pause", data=True)
    rig.while_spinning = [lambda: setattr(stop, "signal", 2)]
    assert rig.controls.hold(stop) == 2.0


def test_each_rover_is_reset_by_itself_and_a_pause_is_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    other, one = Rig(monkeypatch), Rig(monkeypatch)  # the later clock holds
    shared = Controls([(one.node, lambda: 1_000_000_000), (other.node, lambda: None)])
    assert one.ask("~/reset") == (True, "the rover goes back to its start at t = 1.00 s")
    assert other.ask("~/reset")[0] is False
    assert other.ask("~/pause", data=True) == (True, "paused at t = 0.00 s")
    assert one.ask("~/pause", data=True) == (True, "paused already at t = 0.00 s")
    one.while_spinning.append(lambda: other.ask("~/pause", data=False))
    assert shared.hold(StopRequest()) == 2.0
