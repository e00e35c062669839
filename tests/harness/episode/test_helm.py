"""A run that is steered: nothing changes where nobody does; pauses, paces and thresholds hold."""

import signal
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import pytest

from harness.base.interrupt import StopRequest
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.helm import Helm, Order
from harness.episode.result import Outputs, RunResult
from harness.samples import Place, Twist
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from rover_metrics.core.thresholds import Thresholds

RUN = Run.of(terrain="rocky", driver="wander", duration=6.0, lidar_beams=36)
BY_HAND = Order(driver="cmd_vel", command=Twist(0.3, 0.2), held=True)


class At:
    """An observer that acts once a simulated time [s] has come, as whoever looks at the run would."""

    def __init__(self, **acts: Callable[[], object]) -> None:
        self._acts = {float(at.lstrip("t").replace("_", ".")): act for at, act in acts.items()}

    def take(self, batch: Batch) -> None:
        for at in [at for at in self._acts if at * 1e9 <= batch.truth.time_ns]:
            self._acts.pop(at)()


def driven(
    folder: Path, run: Run, helm: Helm | None, *observers: At, stop: StopRequest | None = None
) -> tuple[bytes, RunResult]:
    """The bytes of the log, and the result."""
    outputs = [Outputs(log_dir=folder, observers=observers)]
    (result,) = run_direct(run, outputs, RosOptions(log_dir=folder), stop or StopRequest(), None, helm)
    assert result.log_path is not None
    return result.log_path.read_bytes(), result


def test_a_run_that_nobody_steers_is_the_same_to_the_byte(tmp_path: Path) -> None:
    helm = Helm(None, StopRequest())
    watched, result = driven(tmp_path / "a", RUN, helm)
    alone, _ = driven(tmp_path / "b", RUN, None)
    assert watched == alone
    assert (helm.driven(RUN), helm.note(RUN)) == (RUN, "")
    assert result.paused_s == 0.0


def test_whether_a_command_is_held_is_said_by_the_last_one_alone() -> None:
    assert BY_HAND.then(Order(goal=Place(1.0, 0.0, 0.0))).held
    assert not BY_HAND.then(Order(command=Twist(0.1, 0.0))).held


def test_paused_it_stands_still_and_goes_on_step_by_step(tmp_path: Path) -> None:
    helm, seen = Helm(None, StopRequest()), list[int]()
    idled: list[int] = []

    def look() -> None:
        """Of a run that is paused: a step each time, in the end it goes on."""
        idled.append(seen[-1])
        time.sleep(0.01)
        if len(idled) % 2:
            helm.step()
        if len(idled) > 6:
            helm.paused = False

    class Seen(At):
        def take(self, batch: Batch) -> None:
            seen.append(batch.truth.time_ns)
            super().take(batch)

    helm.idle = look
    bytes_, result = driven(tmp_path / "a", RUN, helm, Seen(t2=lambda: setattr(helm, "paused", True)))
    assert len(set(idled)) >= 3
    assert {b - a for a, b in pairwise(idled)} == {0, 50_000_000}
    assert result.paused_s >= 0.01 * len(idled)
    assert bytes_ == driven(tmp_path / "b", RUN, None)[0]


def test_a_stop_ends_a_run_that_is_paused_and_a_rate_holds_from_then_on(tmp_path: Path) -> None:
    stop = StopRequest()
    helm = Helm(None, stop)
    helm.rate = 20.0
    began = time.monotonic()
    driven(tmp_path / "a", RUN.but(duration=2.0), helm)
    assert time.monotonic() - began >= 0.09
    helm = Helm(None, stop)
    helm.paused = True
    helm.idle = lambda: setattr(stop, "signal", signal.SIGINT)
    _, result = driven(tmp_path / "b", RUN, helm, stop=stop)
    assert result.simulated_s <= 0.1


def test_thresholds_hold_from_the_next_sample_on_and_the_result_says_so(tmp_path: Path) -> None:
    helm = Helm(None, StopRequest())
    eager = Thresholds(collision_threshold=9.0, smoothness_threshold=3.0)

    def judge() -> None:
        """Moves two thresholds, one after the other, before either holds."""
        helm.judge(0, replace(helm.thresholds(0), collision_threshold=9.0))
        helm.judge(0, replace(helm.thresholds(0), smoothness_threshold=3.0))

    log, result = driven(tmp_path / "a", RUN, helm, At(t3=judge))
    alone, _ = driven(tmp_path / "b", RUN, None)
    assert log.splitlines()[:3] == alone.splitlines()[:3]
    assert int(log.splitlines()[-1].split(b",")[1]) > 20
    assert result.thresholds == eager
    assert "do not repeat" in helm.note(RUN)


def test_a_new_pace_holds_from_now_on_and_makes_up_for_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    stop, slept = StopRequest(), list[float]()
    monkeypatch.setattr(stop, "sleep", slept.append)
    helm = Helm(1.0, stop)
    helm.begin()
    helm.rate = 10.0
    for seconds in (100, 200):
        helm.wait_until(seconds * 10**9)
    assert 9.0 < sum(slept) <= 10.0
    looks = iter((0.0, 60.0))  # a minute passes while it is paused
    monkeypatch.setattr("harness.episode.helm.time", SimpleNamespace(monotonic=looks.__next__))
    helm.paused, helm.idle = True, lambda: setattr(helm, "paused", False)
    helm.go_on(210 * 10**9)
    assert (helm.held_s, 60.0 < sum(slept[-1:]) <= 71.0) == (60.0, True)


def test_a_step_that_is_asked_for_while_a_run_goes_on_is_none_when_it_is_paused() -> None:
    helm = Helm(None, StopRequest())
    helm.step()
    helm.go_on(0)
    assert not helm.take_step()
