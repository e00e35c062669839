"""Episodes of one world, driven together: period after period, or ahead on a second core."""

from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from harness.base.errors import RunFailed
from harness.base.interrupt import Interrupted
from harness.base.sim_time import TICKS_PER_CONTROL
from harness.episode.batch import Batch

if TYPE_CHECKING:
    from harness.episode.episode import Episode

WAITING = 3  # control periods that may be made before they are asked for
Ordered = Callable[[], Callable[[], None] | None]


class Together:
    """Drives episodes that share a world, one control period at a time.

    Args:
        episodes: Of all rovers of the world.
        ordered: Is asked once before each control period what is to be done at its beginning.
        ahead: Whether a second core may simulate a period while the one before is observed: then
            nobody but `ordered` may act on the episodes.
        awake: Whether the two cores wait for each other awake, as `Aside` has it: nothing else is to be
            done meanwhile.
    """

    def __init__(
        self,
        episodes: "Sequence[Episode]",
        ordered: Ordered = lambda: None,
        *,
        ahead: bool = False,
        awake: bool = False,
    ) -> None:
        self._episodes, self._physics = episodes, episodes[0].simulation.physics
        self._total = episodes[0].run.total_ticks
        each_tick = any(episode.looks_at_each_tick for episode in episodes)
        self._span = 1 if each_tick else self._physics.span
        self._ahead, self._awake = ahead and self._physics.can_launch, awake
        self._asked = _Asked(ordered)
        self._next = 0  # tick with which the next period begins
        self._is_begun = False  # whether its commands are given, and the second core may be at it
        self._made: deque[tuple[tuple[Batch, ...], RunFailed | None]] = deque()  # not yet yielded
        # Met too early: of the period that is made next.
        self._error: Exception | SystemExit | None = None

    def batches(self) -> Generator[tuple[Batch, ...]]:
        """Yields a batch of each episode, control period after control period.

        Raises:
            RunFailed: A rover left the map or the simulation diverged; the ticks up to then have been
                yielded.
        """
        try:
            while self._made or self._next < self._total:
                if not self._made:
                    self._make()
                period, failure = self._made.popleft()
                yield period
                if failure is not None:
                    raise failure
        finally:
            self._physics.stay()
            self._error = None  # whose traceback would keep the world until garbage is collected

    def hasten(self) -> None:
        """Makes the next period now if what the second core does is done, so that it can go on at once.

        To be called by the consumer, now and then: else the second core waits until the next batch is
        taken. Up to WAITING periods are made before they are asked for, so that the consumer has
        something to do while one takes long. Orders come into effect that much later.
        """
        if len(self._made) < WAITING and self._error is None and self._physics.has_landed:
            with self._later():
                self._make()

    @contextmanager
    def _later(self) -> Iterator[None]:
        """Keeps what is raised, by a driver, say, for the period that is made next."""
        try:
            yield
        except Interrupted:
            raise
        except (Exception, SystemExit) as error:  # noqa: BLE001
            self._error = error

    def _make(self) -> None:
        """Simulates and observes the next control period, of which the second core may have begun."""
        start, failure = self._next, None
        stop = min(start + TICKS_PER_CONTROL, self._total)
        try:
            self._drive(start, stop)
        except RunFailed as error:
            failure = error
        is_last = failure is not None or stop == self._total
        period = tuple(episode.end_period(is_last=is_last) for episode in self._episodes)
        self._made.append((period, failure))
        self._next = stop

    def _drive(self, start: int, stop: int) -> None:
        if self._error is not None:
            raise self._error
        is_begun, self._is_begun = self._is_begun, False
        if not is_begun:
            self._asked.act()
            for episode in self._episodes:
                episode.begin_period(start)
        for episode in self._episodes:
            episode.begin_observing()
        for first in range(start, stop, self._span):
            ticks = min(self._span, stop - first)
            if not is_begun:
                self._command_wheels(ticks)
            may_begin = self._ahead and stop < self._total and self._may_go_ahead(stop)
            self._physics.run()  # waits for the other core: all that can be asked before has been
            if may_begin and self._physics.show_end():
                with self._later():
                    self._go_ahead(stop)
            _observe(self._episodes, first, ticks)

    def _may_go_ahead(self, tick: int) -> bool:
        """Whether nobody acts between two control periods, of which the next begins at a tick."""
        free = all(episode.can_go_ahead(tick) for episode in self._episodes)
        return free and self._asked.is_nothing()

    def _go_ahead(self, tick: int) -> None:
        """Begins the control period after the one that has been simulated."""
        self._asked.act()
        for episode in self._episodes:
            episode.look_ahead(tick)
        for episode in self._episodes:
            episode.begin_period(tick)
        end = min(tick + TICKS_PER_CONTROL, self._total)
        self._command_wheels(end - tick)
        errands = [each for episode in self._episodes for each in episode.errands(end)]
        self._physics.launch(errands, awake=self._awake)
        self._is_begun = True

    def _command_wheels(self, ticks: int) -> None:
        for episode in self._episodes:
            episode.pilot.drive_wheels(ticks)


class _Asked:
    """What is to be done at the beginning of the next control period, asked once for each."""

    def __init__(self, ordered: Ordered) -> None:
        self._ordered, self._answer = ordered, list[Callable[[], None] | None]()

    def is_nothing(self) -> bool:
        if not self._answer:
            self._answer.append(self._ordered())
        return self._answer[0] is None

    def act(self) -> None:
        self.is_nothing()
        act = self._answer.pop()
        if act is not None:
            act()


def _observe(episodes: "Sequence[Episode]", first: int, ticks: int) -> None:
    """Has episodes look at ticks that have just been simulated, of which one is the first."""
    needs = [any(episode.needs(first + tick + 1) for episode in episodes) for tick in range(ticks)]
    for tick in episodes[0].simulation.physics.shown(needs.__getitem__):
        for episode in episodes:
            episode.observe(first + tick + 1)
