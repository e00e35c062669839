"""The program metrics_node as it is installed; without ROS 2 it ends after one line."""

import sys

from rover_metrics.errors import MissingRosError, run_program
from rover_metrics.ros.arguments import check_words


def main() -> int:
    """Returns the exit code of metrics_node."""
    return run_program("metrics_node", _run)


def _run() -> int:
    check_words("metrics_node", sys.argv[1:])  # before ROS is loaded, which takes a second
    try:
        from rover_metrics.metrics_node import main as run
    except MissingRosError as error:
        print(error, file=sys.stderr)
        return error.exit_code
    return run()


if __name__ == "__main__":
    sys.exit(main())
