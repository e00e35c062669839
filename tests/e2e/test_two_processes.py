"""Several processes over real DDS, as a user starts them, from command line to CSV."""

import csv
import json
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from harness.run import main
from rover_metrics.core.columns import Row
from rover_metrics.errors import LogError
from rover_metrics.log.csv_log import CsvLog
from tests.support.forked_program import ForkedProgram
from tests.support.ros import Ros
from tests.support.waiting import PATIENCE

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

pytestmark = pytest.mark.usefixtures("ros_domain")

SCRIPT = Path(sys.executable).with_name("metrics_node")
NODE = [str(SCRIPT)] if SCRIPT.exists() else [sys.executable, "-m", "rover_metrics.metrics_node"]
HARNESS = [sys.executable, "-m", "harness.run", "--no-metrics", "--wait-for", "/metrics_node"]


@contextmanager
def started(command: list[str], cwd: Path) -> Iterator[subprocess.Popen[str]]:
    """A process with piped output that is gone afterwards, whatever happens."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    with subprocess.Popen(command, cwd=cwd, text=True, **pipes) as process:  # type: ignore[call-overload]
        try:
            yield process
        finally:
            process.kill()


def finished(process: subprocess.Popen[str]) -> str:
    """The whole output of a process that ends by itself."""
    output, _ = process.communicate(timeout=PATIENCE)
    assert "Traceback" not in output
    return output


def set_parameter(ros: Ros, name: str, value: object) -> tuple[bool, str]:
    """As `ros2 param set` does; whether it is set, and why not."""
    wish = Parameter(name, value=value).to_parameter_msg()
    service = "/metrics_node/set_parameters"
    (told,) = ros.ask(ros.node("client"), SetParameters, service, parameters=[wish]).results
    return told.successful, told.reason


def test_parameters_change_at_run_time_and_ctrl_c_ends_both_cleanly(ros: Ros, tmp_path: Path) -> None:
    node_words = ["--ros-args", "-p", "use_sim_time:=true", "-p", f"log_dir:={tmp_path}"]
    with ExitStack() as at_end:
        node = at_end.enter_context(started([*NODE, *node_words], tmp_path))
        words = ["--terrain", "maze", "--driver", "cmd_vel", "--duration", "36000", "--rate", "8"]
        harness = at_end.enter_context(started([*HARNESS, *words], tmp_path))
        ros.until(lambda: len(rows(tmp_path)) >= 3)
        assert rows(tmp_path)[-1]["Total Collisions"] == "0"
        assert set_parameter(ros, "collision_threshold", 9.0) == (True, "")
        accepted, reason = set_parameter(ros, "collision_threshold", -1.0)
        assert not accepted
        assert "collision_threshold" in reason
        ros.until(lambda: int(rows(tmp_path)[-1]["Total Collisions"]) > 0)
        harness.send_signal(signal.SIGINT)
        told = finished(harness)
        assert harness.returncode == 130, told
        node.send_signal(signal.SIGINT)
        said = finished(node)
        assert node.returncode == 0, said
    assert "logging to: " in said
    assert "0 lost" in told
    assert re.search(r"(?m)^/metrics_node: .*% of the run waited for it$", told), told
    assert only_log(tmp_path).endswith(b"Normal operation\r\n")
    stamps = [int(row["Timestamp"]) for row in rows(tmp_path)]
    assert stamps == list(range(1, len(stamps) + 1))


def rows(log_dir: Path) -> list[dict[str, str]]:
    """The whole rows written so far; none before the node has made its file."""
    for log in log_dir.glob("*.csv"):
        with log.open(newline="") as file:
            return [row for row in csv.DictReader(file) if row["Notes"] is not None]
    return []


def only_log(folder: Path) -> bytes:
    (log,) = folder.glob("*.csv")
    return log.read_bytes()


def test_nodes_elsewhere_of_a_fleet_log_what_a_run_without_ros_does(tmp_path: Path) -> None:
    drive = ["--rover", "leo:a", "--rover", "rover_zero4wd:b", "--terrain", "rocky", "--duration", "3"]
    assert main([*drive, "--direct", "--log-dir", str(tmp_path / "direct")]) == 0
    drive += ["--no-metrics", "--log-dir", str(tmp_path)]
    with ExitStack() as at_end:
        for name in ("a", "b"):
            node = ["--ros-args", "-r", f"__ns:=/{name}", "-p", "use_sim_time:=true"]
            node += ["-p", f"log_dir:={tmp_path / name}"]
            at_end.enter_context(ForkedProgram("rover_metrics.metrics_node", node))
            drive += ["--wait-for", f"/{name}/metrics_node"]
        assert main(drive) == 0
    for name in ("a", "b"):
        assert only_log(tmp_path / name) == only_log(tmp_path / "direct" / name)


def test_two_rovers_at_once_with_a_clock_each_do_not_disturb_each_other(tmp_path: Path) -> None:
    def words(name: str, *more: str) -> list[str]:
        quick = ["--terrain", "flat", "--duration", "3", "--seed", "3"]
        return [*quick, "--log-dir", str(tmp_path / name), *more]

    def in_namespace(name: str) -> list[str]:
        return words(name, "--namespace", name, "--ros-args", "-r", f"/clock:=/{name}/clock")

    assert main(words("alone", "--direct")) == 0
    with ForkedProgram("harness.run", in_namespace("rover2")) as other:
        assert main(in_namespace("rover1")) == 0
        assert other.wait(PATIENCE) == 0
    alone, *others = (only_log(tmp_path / name) for name in ("alone", "rover1", "rover2"))
    assert others == [alone] * 2


def test_a_row_that_the_disk_takes_at_the_end_is_no_lost_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, refusals = CsvLog.write, iter([LogError("no space")])

    def write_late(log: CsvLog, row: Row) -> None:
        if log.rows == 1 and (refusal := next(refusals, None)):
            raise refusal
        write(log, row)

    monkeypatch.setattr(CsvLog, "write", write_late)
    assert main(["--terrain", "flat", "--duration", "2", "--log-dir", str(tmp_path)]) == 0
    assert only_log(tmp_path).count(b"\n") == 1 + 2
    (manifest,) = tmp_path.glob("*.json")
    assert json.loads(manifest.read_text())["rows"] == 2
