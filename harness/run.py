"""Command: drive a rover over a terrain and log its traversal metrics.

    python -m harness.run --terrain rocky --robot leo --seed 0

Parses; the rest is in harness.cli.run_command.
"""

import sys
from collections.abc import Sequence

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.run")


with loading():
    from harness.cli.run_parser import parsed


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    return run_program("harness.run", lambda: _main(sys.argv[1:] if arguments is None else arguments))


def _main(arguments: Sequence[str]) -> int:
    given, ros_args = parsed(arguments)
    with loading():
        from harness.cli.run_command import run_command
    return run_command(given, ros_args, arguments)


if __name__ == "__main__":
    sys.exit(main())
