"""The soak in 15 simulated seconds: nothing lost, nothing grown, the bytes of an undisturbed run."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.base.errors import RunFailed

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from benchmarks.soak.drive import drive, running
from benchmarks.soak.outcome import COLUMNS, GROWTH, Outcome
from benchmarks.soak.plan import Plan
from benchmarks.soak.scenarios import (
    Reference,
    long_run_in_one_process,
    many_nodes,
    starved,
    stopped_node,
)
from tests.support.forked_program import ForkedProgram
from tests.support.once import made_once

WORLD = ("--terrain", "flat", "--timestep", "0.005", "--lidar-beams", "90")  # light ones
PLAN = Plan(long=15, stopped=3, many=1, starved=2, nodes=2, fault_every=1, world=WORLD)


class ForkedPrograms:
    """Stands where the soak looks for `subprocess`: it starts the same programs, loaded already."""

    DEVNULL, TimeoutExpired = subprocess.DEVNULL, subprocess.TimeoutExpired

    @staticmethod
    def Popen(command: Sequence[str], *, stdout: Any, stderr: Any) -> Any:  # noqa: ANN401, N802
        if [*command[:2]] != [sys.executable, "-m"]:
            return subprocess.Popen(command, stdout=stdout, stderr=stderr)
        return ForkedProgram(command[2], command[3:], getattr(stdout, "name", os.devnull))


@pytest.fixture(scope="module", autouse=True)
def _forked() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("benchmarks.soak.drive.subprocess", ForkedPrograms)
        yield


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Reference:
    folder = tmp_path_factory.mktemp("reference")
    return made_once(tmp_path_factory, "soak_reference", lambda: Reference(PLAN, folder))


@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("scenario", [long_run_in_one_process, stopped_node, many_nodes, starved])
def test_nothing_is_lost_and_nothing_grows(
    scenario: Callable[[Plan, Reference, Path], Outcome],
    reference: Reference,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("benchmarks.resident.MINUTE", 3)  # what is light has filled its buffers by then
    monkeypatch.setattr("benchmarks.soak.scenarios.RIVALS_PER_CORE", 2)  # a third is left, not a fifth
    outcome = scenario(PLAN, reference, tmp_path)
    assert outcome.complaints == ()
    assert outcome.messages > 250 * outcome.seconds
    assert set(outcome.grown) == ({"harness", "simulation"} if outcome.seconds == PLAN.long else set())


FINE = Outcome(
    scenario="a run",
    seconds=7200,
    failure=None,
    speed=50.0,
    messages=2_000_000,
    lost=0,
    rows=(7200, 7200),
    same=True,
    grown={"harness": 2 * GROWTH},
)


def test_outcome_without_harm_has_no_complaint() -> None:
    assert FINE.complaints == ()
    assert len(FINE.cells()) == len(COLUMNS)


@pytest.mark.parametrize(
    ("harm", "complaint"),
    [
        ({"lost": 1}, "1 messages lost"),
        ({"failure": "failed: it hangs"}, "failed: it hangs"),
        ({"rows": (7200, 7199)}, "rows: 7200, 7199 instead of 7200"),
        ({"same": False}, "a log differs from that of the run without ROS"),
        ({"grown": {"harness": 2.01 * GROWTH}}, "harness grew by +10.05 MB"),
        ({"seconds": 60, "rows": (60,), "grown": {"node": 1.01 * GROWTH}}, "node grew by +5.05 MB"),
    ],
)
def test_outcome_complains_of_each_harm(harm: dict[str, object], complaint: str) -> None:
    assert replace(FINE, **harm).complaints == (f"a run: {complaint}",)  # type: ignore[arg-type] # one of many


def test_stopped_process_is_gone_at_the_end_of_a_scenario_that_is_interrupted() -> None:
    command = [sys.executable, "-S", "-c", "while True: pass"]

    def interrupted() -> None:
        with running(command, subprocess.DEVNULL) as process:
            processes.append(process)
            os.kill(process.pid, signal.SIGSTOP)
            raise KeyboardInterrupt

    processes: list[subprocess.Popen[bytes]] = []
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert processes[0].poll() == -signal.SIGTERM


def test_run_that_refuses_its_arguments_is_told_in_its_own_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refusing = (sys.executable, "-S", "-c", "import sys; sys.exit('harness.run: no such terrain')")
    monkeypatch.setattr("benchmarks.soak.drive.HARNESS", refusing)
    with pytest.raises(RunFailed, match=r"ended with 1: harness\.run: no such terrain"):
        drive([], tmp_path, lambda _: None)
