"""The command harness.teleop in a terminal of its own, against who hears /cmd_vel."""

import io
import os
import pty
import signal
import subprocess
import sys
import termios
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import Twist, TwistStamped

from harness import teleop
from tests.support.ros import Ros
from tests.support.waiting import PATIENCE


class Terminal:
    """A terminal in which the command runs."""

    def __init__(self, *words: str) -> None:
        self._own, self.inner = pty.openpty()
        self.before = termios.tcgetattr(self.inner)
        command = [sys.executable, "-m", "harness.teleop", *words]
        self.run = subprocess.Popen(
            command, stdin=self.inner, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )

    def type(self, text: str) -> None:
        os.write(self._own, text.encode())

    def ended(self) -> int:
        """The exit code; the terminal is as it was."""
        code = self.run.wait(PATIENCE)
        assert termios.tcgetattr(self.inner) == self.before
        return code

    def close(self) -> None:
        self.run.kill()
        self.run.communicate()
        os.close(self._own)
        os.close(self.inner)


@contextmanager
def terminal(*words: str) -> Iterator[Terminal]:
    made = Terminal(*words)
    try:
        yield made
    finally:
        made.close()


def test_keys_drive_and_what_is_let_go_of_stops_and_q_ends_it(ros: Ros) -> None:
    heard: list[tuple[float, float]] = []
    node = ros.node("rover")
    node.create_subscription(
        Twist, "/a/cmd_vel", lambda told: heard.append((told.linear.x, told.angular.z)), 100
    )
    with terminal("--namespace", "a", "--speed", "0.2", "--turn", "0.5") as used:
        ros.until(lambda: node.count_publishers("/a/cmd_vel"))
        assert used.run.stdout is not None
        assert "/a/cmd_vel" in used.run.stdout.readline()

        def driven(keys: str, twist: tuple[float, float]) -> None:
            def has_come() -> bool:
                used.type(keys)
                return heard[-1:] == [twist]

            ros.until(has_come)

        assert heard == []  # somebody else may drive
        driven("i", (0.2, 0.0))
        driven("I", (0.2, 0.0))
        driven("ij", (0.2, 0.5))
        driven("kl", (-0.2, -0.5))
        ros.until(lambda: heard[-1:] == [(0.0, 0.0)])  # let go of
        driven("k", (-0.2, 0.0))
        driven("k ", (0.0, 0.0))
        driven("j", (0.0, 0.5))
        used.type("q")
        ros.until(lambda: heard[-1:] == [(0.0, 0.0)])
        assert used.ended() == 0


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_the_rover_and_leaves_the_terminal_as_it_was(
    ros: Ros, ending: signal.Signals
) -> None:
    heard: list[float] = []
    node = ros.node("rover")
    node.create_subscription(
        TwistStamped, "/cmd_vel", lambda told: heard.append(told.twist.linear.x), 100
    )
    with terminal("--cmd-vel", "stamped") as used:

        def drives() -> bool:
            used.type("i")
            return heard[-1:] == [0.4]

        ros.until(drives)
        used.run.send_signal(ending)
        ros.until(lambda: heard[-1:] == [0.0])
        assert used.ended() == 128 + ending


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "start it in a terminal"),
        (("--speed", "0"), "give a number above 0"),
        (("--namespace", "1x"), "is no name in ROS"),
    ],
)
def test_what_cannot_be_is_a_line(
    words: tuple[str, ...], said: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    try:
        code = teleop.main(words)
    except SystemExit as error:
        code = int(str(error.code))
    assert code == 2
    assert said in capfd.readouterr().err
