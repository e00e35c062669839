"""harness.topics as a program: its refusals and its ends."""

import signal
import subprocess
import sys
import time

import pytest

from harness.run import main as run
from harness.topics import main as topics
from tests.support.complaint import complaint
from tests.support.waiting import PATIENCE, wait_until


@pytest.mark.parametrize("seconds", ["0", "-1", "nan", "inf", "soon", "1_0"])
def test_seconds_that_make_no_sense_are_told_in_one_line(
    seconds: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert f"'{seconds}' is not valid" in complaint(topics, [f"--seconds={seconds}"], capsys)


@pytest.mark.parametrize("name", ["é", "1x", "a//b", "a__b", "a b", "a" * 101, "%s"])
def test_a_name_that_ros_does_not_have_is_refused_in_one_line(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for main, flag in ((topics, "--namespace"), (run, "--namespace"), (run, "--wait-for")):
        told = complaint(main, [flag, name], capsys)
        assert f"{flag} '" in told
        assert "is no name in ROS; give letters, digits and single _, no digit first" in told


def test_without_ros_the_command_says_so_in_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "harness.ros.topic_monitor", None)
    assert complaint(topics, [], capsys).startswith("harness.topics: ROS 2 is not importable (")


@pytest.mark.usefixtures("ros_domain")
def test_a_short_look_goes_on_until_it_can_say_that_there_is_nothing(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    monkeypatch.setattr("harness.topics.LONG_ENOUGH", 1.0)
    began = time.monotonic()
    assert topics(["--seconds", "0.01"]) == 1
    assert time.monotonic() - began >= 1.0
    assert "no topics: does anything run" in capfd.readouterr().err


def test_ctrl_c_ends_the_command_with_its_table(ros_domain: int) -> None:
    rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    from sensor_msgs.msg import Imu  # noqa: PLC0415 - most of this file needs no ROS

    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain)
    node = rclpy.create_node("talker", context=context)
    imu, other = (node.create_publisher(Imu, name, 10) for name in ("a/imu", "b/imu"))
    words = [sys.executable, "-m", "harness.topics", "--namespace", "a"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as command:
        try:
            wait_until(lambda: imu.get_subscription_count() == 1)
            command.send_signal(signal.SIGINT)
            out, err = command.communicate(timeout=PATIENCE)
        finally:
            command.kill()
    assert (command.returncode, err) == (0, "")
    assert "/a/imu" in out
    assert ("/b/imu" in out, other.get_subscription_count()) == (False, 0)
    node.destroy_node()
    context.shutdown()
