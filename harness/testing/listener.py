"""What follows a trial from inside: a scenario's run is one."""

from harness.episode.batch import Batch
from harness.samples import Tick
from harness.testing.process import Programs


class TrialListener:
    """Follows what happens in a trial; a subclass overrides what it needs."""

    def begin_programs(self, programs: Programs) -> None:
        """Starts what takes its time while the world is built."""

    def joined(self) -> bool:
        """A node is kept in step from now on; returns whether more is heard since."""
        return False

    def before_tick(self) -> None:
        """The next tick is not made yet."""

    def tick(self, tick: Tick, sent: Tick) -> None:
        """A tick is made, and what faults leave of it; neither has been published."""

    def after_tick(self) -> None:
        """All nodes have handled the tick."""

    def take(self, batch: Batch) -> None:
        """The ticks of a batch have been handled."""
