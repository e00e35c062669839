"""What all commands share on their command line: a known mistake is one line and exit code 2."""

import argparse
from typing import NoReturn

USAGE_EXIT_CODE = 2


class OneLineParser(argparse.ArgumentParser):
    """A parser whose errors are one line that begins with the command's name."""

    def error(self, message: str) -> NoReturn:
        """Prints the message and leaves with exit code 2."""
        command = self.prog.removeprefix("python -m ").removeprefix("rover_metrics.")
        self.exit(USAGE_EXIT_CODE, f"{command}: {' '.join(message.split())}; see --help\n")
