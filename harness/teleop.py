"""Command: drive a rover by the keys of a terminal, also over ssh.

    python -m harness.teleop                        # /cmd_vel, as run --driver cmd_vel hears it
    python -m harness.teleop --namespace rover1 --speed 0.2

The keys are those of the page of `run --live`. A terminal tells of no key that is let go, so one counts
until it was not repeated for a while.
"""

import argparse
import os
import select
import sys
import termios
import time
import tty
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress

from harness.base.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.teleop")

from harness.base.errors import UsageError, needing_ros
from harness.base.interrupt import Overdue, StopRequest
from harness.base.ros_names import namespace_of
from harness.view.live.keys import DIRECTIONS, HELD, STANDING, Keys
from rover_metrics.errors import complain
from rover_metrics.parser import OneLineParser, positive

PERIOD = 0.05  # [s] between two commands, as between two control periods at --rate 1
LOOK = 3.0  # [s] for somebody to listen before a warning
QUIT, END_OF_INPUT = "Q", "\x04"
HELP = ", ".join(f"{key} {about}" for key, (about, *_) in DIRECTIONS.items())
Send = Callable[[float, float], object]


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    return run_program("harness.teleop", lambda: _main(options))


def _main(options: argparse.Namespace) -> int:
    space = namespace_of(options.namespace)
    if not sys.stdin.isatty():
        raise UsageError("teleop reads keys: start it in a terminal (over ssh: ssh -t)")
    with needing_ros():
        from harness.ros.commander import commander  # noqa: PLC0415 - see needing_ros
    with StopRequest() as stop, commander(space, options.cmd_vel) as out, _keyboard() as pressed:
        publisher, command = out
        keys = f"{HELP}, held, also two at once; any other key stops, {QUIT} ends"
        print(f"{publisher.topic_name}: {keys}", flush=True)  # also into a pipe, before the first key

        def send(forward: float, left: float) -> None:
            command(forward * options.speed, left * options.turn)

        with suppress(Overdue), stop.deferred():
            _drive(pressed, send, publisher.get_subscription_count, stop)
    return stop.exit_code


def _drive(
    pressed: Callable[[float], str | None], send: Send, listeners: Callable[[], int], stop: StopRequest
) -> None:
    """Sends what keys say until one of them, or a signal, ends it."""
    keys, moving, look_at = Keys(), False, time.monotonic() + LOOK
    while stop.signal is None:
        text = pressed(PERIOD)
        if text is None or QUIT in text or END_OF_INPUT in text:
            return
        for key in text:
            if key in DIRECTIONS:
                keys.press(*DIRECTIONS[key][1:])
            else:
                keys.forget()
        share = keys.share
        if moving or share != STANDING:  # else somebody else may drive
            send(*share)
        moving = share != STANDING
        if time.monotonic() > look_at:
            look_at = float("inf")
            if not listeners():
                complain("harness.teleop", "nobody listens yet; run --driver cmd_vel --rate 1 does")


@contextmanager
def _keyboard() -> Iterator[Callable[[float], str | None]]:
    """Yields what returns the keys pressed within so long [s], as capitals; None at the end of all."""
    fd = sys.stdin.fileno()
    before = termios.tcgetattr(fd)

    def pressed(seconds: float) -> str | None:
        try:
            if not select.select([fd], [], [], seconds)[0]:
                return ""
            return os.read(fd, 64).decode(errors="replace").upper() or None
        except OSError:  # the terminal is gone
            return None

    tty.setcbreak(fd)
    try:
        yield pressed
    finally:
        with suppress(termios.error):  # the terminal may be gone
            termios.tcsetattr(fd, termios.TCSAFLUSH, before)


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.teleop",
        description=f"Drives a rover by keys of this terminal: {HELP}. What is not held for {HELD:g} s "
        "is let go of; then the rover is told to stand, once.",
    )
    parser.add_argument("--namespace", default="", metavar="NS", help="of the rover; default: none")
    for name, default, about in (
        ("--speed", 0.4, "forwards [m/s]; default: 0.4"),
        ("--turn", 0.8, "to the left [rad/s]; default: 0.8"),
    ):
        parser.add_argument(name, type=positive, default=default, metavar="V", help=about)
    about = "type of /cmd_vel; default: twist"
    parser.add_argument("--cmd-vel", choices=("twist", "stamped"), default="twist", help=about)
    return parser


if __name__ == "__main__":
    sys.exit(main())
