"""Command: statistics and plots of metrics logs.

    python -m rover_metrics.analyze LOG... [-m CODE...] [-p PLOT...] [--versus LOG...]

Parses, calls; the work is in rover_metrics.analysis. Needs no ROS.
"""

import sys
from collections.abc import Sequence

from rover_metrics.errors import run_program


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command.

    Returns the exit code: 0 if every log was analysed, 1 if any was skipped, 2 after a known mistake.
    """
    try:
        from rover_metrics.analysis.options import parse

        options = parse(arguments)
        from rover_metrics.analysis.command import analyze
    except ImportError as error:
        needed = "five libraries: pip install matplotlib numpy pandas rich scipy"
        print(f"analyze needs {needed} ({error})", file=sys.stderr)
        return 2
    return run_program("analyze", lambda: analyze(options))


if __name__ == "__main__":
    sys.exit(main())
