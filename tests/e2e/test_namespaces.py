"""Rovers in namespaces: one alone, and two at once in one domain, each with a clock of its own."""

from pathlib import Path

import pytest

from harness.run import main
from tests.support.forked_program import ForkedProgram
from tests.support.waiting import PATIENCE

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
pytestmark = pytest.mark.usefixtures("ros_domain")

QUICK = ["--terrain", "flat", "--duration", "3", "--seed", "3"]


def only_log(folder: Path) -> bytes:
    (log,) = folder.glob("*.csv")
    return log.read_bytes()


def in_namespace(name: str, folder: Path) -> list[str]:
    own_clock = ["--ros-args", "-r", f"/clock:=/{name}/clock"]
    return [*QUICK, "--log-dir", str(folder), "--namespace", name, *own_clock]


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The log of the same drive without a namespace and without ROS."""
    folder = tmp_path_factory.mktemp("alone")
    assert main([*QUICK, "--direct", "--log-dir", str(folder)]) == 0
    return only_log(folder)


def test_two_rovers_at_once_with_a_clock_each_do_not_disturb_each_other(
    alone: bytes, tmp_path: Path
) -> None:
    with ForkedProgram("harness.run", in_namespace("rover2", tmp_path / "rover2")) as other:
        assert main(in_namespace("rover1", tmp_path / "rover1")) == 0
        assert other.wait(PATIENCE) == 0
    for name in ("rover1", "rover2"):
        assert only_log(tmp_path / name) == alone
