"""What a process inherits from whoever starts it, brought to what a user's terminal gives."""

import os
import signal
import sys
import tempfile
from types import FrameType

# They steer how rich and ROS 2 write to a terminal, which is no matter of the code under test.
STYLE = (
    *("COLUMNS", "LINES", "NO_COLOR", "FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE"),
    *("RCUTILS_COLORIZED_OUTPUT", "RCUTILS_CONSOLE_OUTPUT_FORMAT", "RCUTILS_LOGGING_USE_STDOUT"),
)
STOPPING = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM)


def receive_signals() -> None:
    """Lets signals reach the children of this process, which inherit what it ignores and blocks.

    nohup, a job in the background and many CI runners ignore some. This process goes on as if it
    ignored them: a handler, other than ignoring, is not inherited by a program that it starts.
    """
    ignored = [number for number in STOPPING if signal.getsignal(number) is signal.SIG_IGN]
    if "PYTEST_XDIST_WORKER" in os.environ:
        ignored.append(signal.SIGHUP)  # a worker leaves when the process that started it does
    for number in ignored:
        signal.signal(number, _nothing)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # else no child has an exit code
    signal.pthread_sigmask(signal.SIG_SETMASK, ())


def _nothing(_: int, __: FrameType | None) -> None:
    """Stays alive."""


def settle_environment() -> str:
    """Sets the variables that tests rely on; gives the folder where ROS 2 logs, which needs no HOME."""
    for name in STYLE:
        os.environ.pop(name, None)
    # Where no bytecode may be kept, every process compiles all of the project and every test anew.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    # A wrongly typed field must raise, not be sent as garbage.
    os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_LOG_DIR"] = tempfile.mkdtemp(prefix="rover_tests_ros_log_")
    return os.environ["ROS_LOG_DIR"]
