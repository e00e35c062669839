"""Python as Windows has it, as far as that shows here: no fork, no signal masks, no folders as files.

Third-party libraries know by the system's name what there is, so they are loaded before it goes.
"""

import importlib
import os
import signal
import sys
from collections.abc import Callable
from typing import Any

LIBRARIES = (
    *("PIL.Image", "jinja2", "joblib.externals.loky", "matplotlib.pyplot", "mcap.reader", "mujoco"),
    *("multiprocessing.resource_tracker", "numba", "pandas", "rich.progress", "rosbags.rosbag2"),
    *("scipy.stats", "sklearn.isotonic", "subprocess", "tempfile", "tifffile"),
)
OF_SIGNALS = (
    *("SIGALRM", "SIGCHLD", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGQUIT", "SIGUSR1", "SIGUSR2"),
    *("ITIMER_REAL", "alarm", "getitimer", "pause", "pthread_kill", "pthread_sigmask", "setitimer"),
)
OF_SYSTEM = (
    *("O_DIRECTORY", "O_NOFOLLOW", "chown", "fchmod", "fork", "forkpty", "getgid", "getloadavg"),
    *("geteuid", "getpgid", "getuid", "killpg", "mkfifo", "posix_spawn", "sched_getaffinity", "setsid"),
    *("statvfs", "sync", "sysconf", "uname", "wait3"),
)
MODULES = ("_posixshmem", "fcntl", "grp", "pty", "pwd", "resource", "syslog", "termios", "tty")


def hide_posix() -> None:
    """Takes from this process what Windows lacks; the project's modules will be loaded anew."""
    for name in LIBRARIES:
        importlib.import_module(name)
    for name in [each for each in sys.modules if each.partition(".")[0] in {"harness", "rover_metrics"}]:
        del sys.modules[name]
    for owner, names in ((signal, OF_SIGNALS), (os, OF_SYSTEM)):
        for name in names:
            delattr(owner, name)
    sys.modules.update(dict.fromkeys(MODULES))  # type: ignore[arg-type]  # None: cannot be imported
    os.open = _opening_no_folder(os.open)


def _opening_no_folder(opened: Callable[..., int]) -> Callable[..., int]:
    def open_file(path: Any, *args: Any, **kwargs: Any) -> int:  # noqa: ANN401 - as os.open
        if os.path.isdir(path):  # noqa: PTH112 - any kind of path
            raise PermissionError(13, "Permission denied", path)
        return opened(path, *args, **kwargs)

    return open_file
