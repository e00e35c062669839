"""Episodes of one world, driven together: period after period, or ahead on a second core."""

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from harness.base.errors import RunFailed
from harness.base.sim_time import TICKS_PER_CONTROL
from harness.episode.batch import Batch

if TYPE_CHECKING:
    from harness.episode.episode import Episode

Ordered = Callable[[], Callable[[], None] | None]


def together(
    episodes: Sequence["Episode"],
    ordered: Ordered = lambda: None,
    *,
    ahead: bool = False,
    awake: bool = False,
) -> Iterator[tuple[Batch, ...]]:
    """Drives episodes that share a world, one control period at a time: a batch of each.

    Args:
        episodes: Of all rovers of the world.
        ordered: Is asked once before each control period what is to be done at its beginning.
        ahead: Whether a second core may simulate a period while the one before is observed: then
            nobody but `ordered` may act on the episodes.
        awake: Whether the two cores wait for each other awake, as `Aside` has it: nothing else is to be
            done meanwhile.

    Raises:
        RunFailed: A rover left the map or the simulation diverged; the ticks up to then have been
            yielded.
    """
    physics, total = episodes[0].simulation.physics, episodes[0].run.total_ticks
    span = 1 if any(episode.looks_at_each_tick for episode in episodes) else physics.span
    ahead, is_begun = ahead and physics.can_launch, False
    asked = _Asked(ordered)
    try:
        for start in range(0, total, TICKS_PER_CONTROL):
            stop, failure = min(start + TICKS_PER_CONTROL, total), None
            if not is_begun:
                asked.act()
                for episode in episodes:
                    episode.begin_period(start)
            for episode in episodes:
                episode.begin_observing()
            try:
                for first in range(start, stop, span):
                    ticks = min(span, stop - first)
                    for episode in () if is_begun else episodes:
                        episode.pilot.drive_wheels(ticks)
                    may_begin = ahead and stop < total and _may_go_ahead(episodes, stop, asked)
                    physics.run()  # waits for the other core: all that can be asked before has been
                    is_begun = may_begin and _goes_ahead(episodes, stop, asked, awake=awake)
                    _observe(episodes, first, ticks)
            except RunFailed as error:
                failure = error
            is_last = failure is not None or stop == total
            yield tuple(episode.end_period(is_last=is_last) for episode in episodes)
            if failure is not None:
                raise failure
    finally:
        physics.stay()


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


def _may_go_ahead(episodes: Sequence["Episode"], tick: int, asked: _Asked) -> bool:
    """Whether nobody acts between two control periods, of which the next begins at a tick."""
    return all(episode.can_go_ahead(tick) for episode in episodes) and asked.is_nothing()


def _goes_ahead(episodes: Sequence["Episode"], tick: int, asked: _Asked, *, awake: bool) -> bool:
    """Begins the control period after the one that has been simulated, if all is well."""
    physics, rest = episodes[0].simulation.physics, episodes[0].run.total_ticks - tick
    if not physics.show_end():
        return False
    asked.act()
    for episode in episodes:
        episode.look_ahead(tick)
    for episode in episodes:
        episode.begin_period(tick)
        episode.pilot.drive_wheels(min(TICKS_PER_CONTROL, rest))
    end = tick + min(TICKS_PER_CONTROL, rest)
    physics.launch([each for episode in episodes for each in episode.errands(end)], awake=awake)
    return True


def _observe(episodes: Sequence["Episode"], first: int, ticks: int) -> None:
    """Has episodes look at ticks that have just been simulated, of which one is the first."""
    needs = [any(episode.needs(first + tick + 1) for episode in episodes) for tick in range(ticks)]
    for tick in episodes[0].simulation.physics.shown(needs.__getitem__):
        for episode in episodes:
            episode.observe(first + tick + 1)
