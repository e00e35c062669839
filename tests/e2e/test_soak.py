"""The soak in 15 simulated seconds: nothing lost, nothing grown, the bytes of an undisturbed run."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from benchmarks.resident import Growth
from benchmarks.soak.drive import running
from benchmarks.soak.outcome import GROWTH, Outcome
from benchmarks.soak.plan import Plan
from benchmarks.soak.scenarios import (
    Reference,
    long_run_in_one_process,
    many_nodes,
    starved,
    stopped_node,
)
from harness.run import main
from rover_metrics.core.columns import Row
from rover_metrics.log.csv_log import CsvLog
from tests.support.forked_program import ForkedProgram
from tests.support.once import made_once

WORLD = ("--terrain", "flat", "--timestep", "0.005", "--lidar-beams", "90")  # light ones
PLAN = Plan(long=15, stopped=3, many=1, starved=2, nodes=2, fault_every=1, world=WORLD)


HALTS = (
    4,
    8,
    12,
)  # rows after which a run stands still until it was looked at: it takes a quarter of a second


def halting(words: list[str]) -> int:
    """harness.run, which nobody is too slow to look at between two halts."""
    write = CsvLog.write

    def write_and_halt(log: CsvLog, row: Row) -> None:
        write(log, row)
        if log.rows in HALTS:
            signal.raise_signal(signal.SIGSTOP)

    CsvLog.write = write_and_halt  # type: ignore[method-assign, assignment]
    return main(words)


class ForkedPrograms:
    """Stands where the soak looks for `subprocess`: it starts the same programs, loaded already."""

    DEVNULL, TimeoutExpired = subprocess.DEVNULL, subprocess.TimeoutExpired

    @staticmethod
    def Popen(command: Sequence[str], *, stdout: Any, stderr: Any) -> Any:  # noqa: ANN401, N802
        if [*command[:2]] != [sys.executable, "-m"]:
            return subprocess.Popen(command, stdout=stdout, stderr=stderr)
        program = halting if "harness.run" in command and "--direct" not in command else command[2]
        return ForkedProgram(program, command[3:], getattr(stdout, "name", os.devnull))


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
    look = Growth.look

    def look_and_let_go(growth: Growth, process: int) -> None:
        look(growth, process)
        with suppress(ProcessLookupError):  # it has ended meanwhile
            os.kill(process, signal.SIGCONT)

    monkeypatch.setattr(Growth, "look", look_and_let_go)
    outcome = scenario(PLAN, reference, tmp_path)
    assert outcome.complaints == ()
    assert outcome.messages > 250 * outcome.seconds
    assert set(outcome.grown) == ({"harness"} if outcome.seconds == PLAN.long else set())


def test_outcome_complains_of_each_harm() -> None:
    fine: dict[str, Any] = {
        "failure": None,
        "lost": 0,
        "rows": (60, 60),
        "same": True,
        "grown": {"harness": GROWTH},
    }
    shown: dict[str, Any] = {"scenario": "a run", "seconds": 60, "speed": 50.0, "messages": 20_000}

    def complaints(**harm: Any) -> tuple[str, ...]:  # noqa: ANN401 - fields of an Outcome
        return Outcome(**shown | fine | harm).complaints

    assert complaints() == ()
    assert complaints(lost=1) == ("a run: 1 messages lost",)
    assert complaints(failure="failed: it hangs") == ("a run: failed: it hangs",)
    assert complaints(rows=(60, 59)) == ("a run: rows: 60, 59 instead of 60",)
    assert complaints(same=False) == ("a run: a log differs from that of the run without ROS",)
    assert complaints(grown={"node": 1.01 * GROWTH}) == ("a run: node grew by +5.05 MB",)


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
