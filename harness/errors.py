"""What can go wrong, as types: the commands turn each into one line and an exit code."""


class HarnessError(Exception):
    """Base of everything that this project raises on purpose."""

    exit_code = 1


class UsageError(HarnessError):
    """A known mistake of the caller; its message names the valid choices or the mend."""

    exit_code = 2


class RunFailed(HarnessError):
    """A run that could not be brought to its end; its message says what happened and when."""


class Diverged(RunFailed):
    """The simulation blew up: what it said before is not to be trusted either."""
