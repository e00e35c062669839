"""The sinks that a run's options ask for."""

from contextlib import ExitStack

from harness.base.errors import UsageError
from harness.messages.sink import Sink
from harness.spec.ros import RosOptions

INSTALL = "install it with pip install 'rover-harness[foxglove]'"


def sinks_of(options: RosOptions, at_end: ExitStack) -> list[Sink]:
    """Opens the recording and serves Foxglove, if options ask for them, until `at_end` closes them.

    Raises:
        UsageError: One cannot be opened.
    """
    sinks: list[Sink] = []
    if options.record is not None:
        from harness.messages.recorder import Recorder  # noqa: PLC0415 - most runs record nothing

        sinks.append(at_end.enter_context(Recorder(options.record, overwrite=options.overwrite)))
    if options.foxglove is not None:
        try:
            from harness.messages.foxglove import Foxglove  # noqa: PLC0415 - its extra may be missing
        except ModuleNotFoundError as error:
            raise UsageError(f"--foxglove: {error}; {INSTALL}") from error
        sinks.append(at_end.enter_context(Foxglove(options.foxglove)))
    return sinks
