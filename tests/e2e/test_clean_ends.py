"""However a run ends: soon, without a trace on the terminal, and leaving nothing behind."""

import json
import os
import pty
import random
import select
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from harness.base.interrupt import Interrupted
from harness.drivers.base import Observation
from harness.drivers.wander import Wander
from harness.episode.batch import Batch
from harness.episode.loop import Observer
from harness.run import main
from harness.samples import Tick, Twist
from harness.spec.run import Run
from harness.view.drawing import Drawing
from tests.support.forked_program import ForkedProgram
from tests.support.shared_memory import shared_memory
from tests.support.waiting import PATIENCE, under_load, wait_until

SOON = 1.0  # [s]: the promise; one of several ends may take longer
NO_HANG = 5.0  # [s]: far less than any patience of a run for DDS or a node
ENDLESS = ["--terrain", "flat", "--driver", "spin", "--duration", "36000"]
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
STARTS = 12
DRIVING = (0, 4, 8)  # are stopped, one by each signal, when there are rows; others at a random time
THROUGH_ROS = (*DRIVING, 10)  # of them


@dataclass(frozen=True)
class End:
    """How a run ended: seconds after the signal, exit code, output, and what it left behind."""

    after: float
    code: int
    told: str
    left: tuple[str, ...] = ()


def started(log_dir: Path, *words: str) -> ForkedProgram:
    """A run that does not end by itself."""
    all_words = [*ENDLESS, "--log-dir", str(log_dir), *words]
    return ForkedProgram("harness.run", all_words, log_dir.with_suffix(".txt"))


def rows(log_dir: Path) -> int:
    return sum(len(log.read_bytes().splitlines()) - 1 for log in log_dir.glob("*.csv"))


def session_members(session: int) -> list[str]:
    """Processes of a session that are still there."""
    members = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, of_session = path.read_text().rsplit(")", 1)[1].split()[:4]
        except OSError:  # gone meanwhile
            continue
        if int(of_session) == session and state != "Z":
            members.append(path.parent.name)
    return members


def left_behind(memory: set[str]) -> tuple[str, ...]:
    """Files that are still there although nobody uses them."""
    there = {path for path in memory if Path(path).exists()}
    if there:
        for other in Path("/proc").glob("[0-9]*"):
            there -= shared_memory(other.name)
    return tuple(path for path in there if Path(path).exists())


def ended_by(number: signal.Signals, program: ForkedProgram, *, group: bool = False) -> End:
    """Sends a signal, as a terminal does to the whole group if there is one, and waits for the end."""
    memory = shared_memory(program.pid)
    began = time.monotonic()
    (os.killpg if group else os.kill)(program.pid, number)
    code = program.wait(PATIENCE)
    after = time.monotonic() - began
    wait_until(lambda: not session_members(program.pid))
    return End(after, code, program.said.read_text(), left_behind(memory))


def manifest(log_dir: Path) -> dict[str, Any]:
    """The manifest of the only run."""
    (log,) = log_dir.glob("*.csv")
    values: dict[str, Any] = json.loads(log.with_suffix(".json").read_text())
    return values


def test_signal_ends_a_direct_run_even_if_it_is_much_slower_than_real_time(tmp_path: Path) -> None:
    with started(tmp_path / "logs", "--direct", "--rate", "0.01") as program:
        wait_until(lambda: bool(list(tmp_path.glob("logs/*.csv"))))
        end = ended_by(signal.SIGHUP, program)
    assert (end.code, "Traceback" in end.told) == (128 + signal.SIGHUP, False), end.told
    assert end.after < under_load(NO_HANG)


@pytest.mark.usefixtures("ros_domain")
def test_starts_and_stops_in_a_row_end_soon_silently_and_leave_rows_and_manifest(
    tmp_path: Path,
) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    rng = random.Random(0)  # noqa: S311 - no secret
    ends = [started_and_stopped(index, tmp_path / str(index), rng) for index in range(STARTS)]
    assert [end.code for end in ends] == [128 + number_of(index) for index in range(STARTS)]
    assert not [end.told for end in ends if "Traceback" in end.told]
    assert not [end.left for end in ends if end.left]
    assert sorted(end.after for end in ends)[STARTS // 2] < under_load(SOON)
    assert max(end.after for end in ends) < under_load(NO_HANG)
    for index in DRIVING:
        assert " 0 lost" in ends[index].told
        (log,) = (tmp_path / str(index)).glob("*.csv")
        assert log.read_bytes().endswith(b"Normal operation\r\n")
        values = manifest(log.parent)
        assert values["outcome"] == {"status": "interrupted", "reason": number_of(index).name}
        assert values["rows"] == rows(log.parent) > 2


@pytest.mark.usefixtures("ros_domain")
def test_a_node_that_a_signal_leaves_half_made_leaves_nothing_of_dds() -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    kind = import_module("rover_metrics.ros.guarded_node").GuardedNode

    class HalfMade(kind):  # type: ignore[misc, valid-type]  # rclpy has no types
        def create_service(self, *args: object, **options: object) -> None:
            super().create_service(*args, **options)
            raise Interrupted(signal.SIGINT)

    before = shared_memory("self")
    with pytest.raises(Interrupted), import_module("harness.ros.context").ros_context([]) as context:
        HalfMade("half_made", context=context)
    assert shared_memory("self") <= before


def test_closed_terminal_ends_the_run_with_its_manifest(tmp_path: Path) -> None:
    terminal, other_side = pty.openpty()
    words = [*ENDLESS, "--direct", "--rate", "20", "--log-dir", str(tmp_path)]
    program = ForkedProgram("harness.run", words, os.ttyname(other_side))
    os.close(other_side)
    os.set_blocking(terminal, False)
    shown = b""

    def read_on() -> bool:
        nonlocal shown
        if select.select([terminal], [], [], 0.05)[0]:
            shown += os.read(terminal, 65536)
        return rows(tmp_path) > 2

    with program:
        wait_until(read_on)
        began = time.monotonic()
        os.close(terminal)
        assert program.wait(PATIENCE) == 128 + signal.SIGHUP
        assert time.monotonic() - began < under_load(NO_HANG)
    assert b"real time" in shown, "the progress line was to be on the terminal"
    assert manifest(tmp_path)["outcome"] == {"status": "interrupted", "reason": "SIGHUP"}


class SlowDrawing(Drawing):
    """Draws nothing; a signal comes while the run drives, and another while it is drawn."""

    signals: Iterator[signal.Signals]

    def prepare(self, *fleet: Run) -> None:
        """Needs no OpenGL."""

    @property
    def observers(self) -> Sequence[Observer]:
        return [self]

    def take(self, _: Batch) -> None:
        if number := next(SlowDrawing.signals, None):
            signal.raise_signal(number)

    def finish(self, show: Callable[[int, int], None]) -> list[Path]:
        show(0, 1)
        if number := next(SlowDrawing.signals, None):
            signal.raise_signal(number)
        return [Path("drawn.mp4")]


@pytest.mark.parametrize(
    ("signals", "told", "not_told"),
    [
        ([signal.SIGTERM], "nothing was drawn: stopped by SIGTERM", "video: drawn.mp4"),
        ([signal.SIGINT], "video: drawn.mp4", "nothing was drawn"),
        ([signal.SIGINT, signal.SIGINT], "Ctrl-C again leaves it out", "video: drawn.mp4"),
    ],
)
def test_who_stops_a_run_is_not_kept_waiting_by_its_video(
    signals: list[signal.Signals],
    told: str,
    not_told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(SlowDrawing, "signals", iter(signals), raising=False)
    monkeypatch.setattr("harness.cli.run_command.Drawing", SlowDrawing)
    words = [*ENDLESS, "--direct", "--video", "drawn.mp4", "--log-dir", str(tmp_path)]
    assert main(words) == 128 + signals[0]
    shown = "".join(capsys.readouterr())
    assert told in shown
    assert not_told not in shown
    assert manifest(tmp_path)["outcome"] == {"status": "interrupted", "reason": signals[0].name}


def test_a_signal_while_the_manifest_is_written_is_no_fault_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "harness.cli.run_command.write_manifest", lambda *_: signal.raise_signal(signal.SIGTERM)
    )
    words = ["--terrain", "flat", "--duration", "0.5", "--direct", "--log-dir", str(tmp_path)]
    assert main(words) == 128 + signal.SIGTERM


def crash(self: Wander, observation: Observation) -> Twist:  # noqa: ARG001 - a driver's method
    if observation.time_ns >= 1_500_000_000:
        message = "the driver fell asleep"
        raise ZeroDivisionError(message)
    return Twist()


def crashing(words: list[str]) -> int:
    """harness.run with a driver that has a bug."""
    Wander.command = crash  # type: ignore[method-assign]
    return main(words)


@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("way", [[], ["--direct"]])
def test_bug_in_a_driver_shows_its_trace_keeps_the_rows_and_does_not_hang(
    way: list[str], tmp_path: Path
) -> None:
    words = ["--terrain", "flat", "--duration", "36000", "--log-dir", str(tmp_path), *way]
    with ForkedProgram(crashing, words, tmp_path / "said.txt") as program:
        told = program.finished(PATIENCE)
    assert program.returncode == 1
    assert "ZeroDivisionError: the driver fell asleep" in told
    assert "in crash" in told
    assert rows(tmp_path) == 1


@pytest.mark.usefixtures("ros_domain")
def test_rclpy_shut_down_from_outside_fails_the_run_with_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    # The module that the command will find: tests that hide rclpy leave others of its name behind.
    bridge = import_module("harness.ros.rover_nodes").Bridge
    send = bridge.send

    def shut_down(self: Any, tick: Tick, *rest: Any, **more: Any) -> None:  # noqa: ANN401 - needs rclpy
        if tick.stamp_ns == 2_500_000_000:
            self.context.shutdown()
        send(self, tick, *rest, **more)

    monkeypatch.setattr(bridge, "send", shut_down)
    assert main([*ENDLESS, "--log-dir", str(tmp_path)]) == 1
    told = capfd.readouterr().err
    assert "harness.run: ROS 2 was shut down from outside this run" in told
    assert "Traceback" not in told
    assert rows(tmp_path) == 2
    assert manifest(tmp_path)["outcome"]["status"] == "failed"


@pytest.mark.usefixtures("ros_domain")
def test_ctrl_c_ends_a_run_whose_node_has_stopped_answering(tmp_path: Path) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    words = ["--ros-args", "-p", "use_sim_time:=true", "-p", f"log_dir:={tmp_path / 'node'}"]
    summary = tmp_path / "summary.json"
    with ExitStack() as at_end:
        silent = at_end.enter_context(ForkedProgram("rover_metrics.metrics_node", words))
        for_it = ("--no-metrics", "--wait-for", "/metrics_node", "--summary", str(summary))
        run = at_end.enter_context(started(tmp_path / "run", *for_it))
        wait_until(lambda: rows(tmp_path / "node") > 1)
        silent.send_signal(signal.SIGSTOP)
        end = ended_by(signal.SIGINT, run)
    assert end.code == 128 + signal.SIGINT, end.told
    assert "Traceback" not in end.told
    assert end.after < under_load(NO_HANG)
    assert json.loads(summary.read_text())["outcome"]["status"] == "interrupted"


@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_run_whose_node_is_killed_ends_in_time_with_its_name(
    number: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    remote = import_module("harness.ros.remote")
    assert remote.ANSWER_PATIENCE == 30.0, "docs/driving.md states it"
    monkeypatch.setattr(remote, "ANSWER_PATIENCE", patience := 3.0)
    words = ["--ros-args", "-p", "use_sim_time:=true", "-p", f"log_dir:={tmp_path / 'node'}"]
    run = ["--no-metrics", "--wait-for", "/metrics_node", "--log-dir", str(tmp_path / "run")]
    ended, summary = list[float](), tmp_path / "summary.json"
    with ForkedProgram("rover_metrics.metrics_node", words) as node:

        def kill() -> None:
            wait_until(lambda: rows(tmp_path / "node") > 1)
            node.send_signal(number)
            ended.append(time.monotonic())

        killer = threading.Thread(target=kill)
        killer.start()
        assert main([*ENDLESS, *run, "--summary", str(summary)]) == 1
        killer.join()
    assert time.monotonic() - ended[0] < under_load(patience + NO_HANG)
    outcome = json.loads(summary.read_text())["outcome"]
    said = {signal.SIGKILL: "/metrics_node stopped answering", signal.SIGTERM: "/metrics_node has ended"}
    assert (outcome["status"], outcome["reason"]) == ("failed", said[number])


def number_of(index: int) -> signal.Signals:
    return SIGNALS[index % len(SIGNALS)]


def started_and_stopped(index: int, log_dir: Path, rng: random.Random) -> End:
    way = [] if index in THROUGH_ROS else ["--direct"]
    with started(log_dir, *way) as program:
        if index in DRIVING:
            wait_until(lambda: rows(log_dir) > 2)
        else:
            select.select([], [], [], rng.uniform(0.0, 0.25 if way else 1.5))
        # The group is there once the run drives; a run that still loads ends as any program does.
        end = ended_by(number_of(index), program, group=index in DRIVING)
    return replace(end, code=-end.code + 128) if end.code < 0 and index not in DRIVING else end
