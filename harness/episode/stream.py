"""A run as the stream of its batches, and what is ordered of its rovers while the stream is consumed."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from harness.base.edge import loading
from harness.base.sim_time import CONTROL_PERIOD_NS
from harness.episode.batch import Batch
from harness.episode.helm import Order
from harness.episode.together import Together
from harness.samples import Place, Twist
from harness.spec.ros import FrameOptions
from harness.spec.rover import CMD_VEL, RoverSetup
from harness.spec.run import Run

if TYPE_CHECKING:
    from harness.episode.episode import Episode


@dataclass
class Progress:
    """How far the orders of a run have been taken.

    Attributes:
        total: Control periods of the run.
        taken: Those whose orders have been taken.
    """

    total: int
    taken: int = 0

    @property
    def next_ns(self) -> int | None:
        """When what is ordered now comes into effect [ns]; None for never."""
        return None if self.taken == self.total else self.taken * CONTROL_PERIOD_NS


class RoverOrders:
    """What the consumer orders of one rover.

    Args:
        progress: Of the run.
        rover: The rover's setup.

    Attributes:
        obeys: Whether its driver takes commands.
        is_shared: Whether anything was ordered otherwise than by `give`.
    """

    def __init__(self, progress: Progress, rover: RoverSetup) -> None:
        self._progress = progress
        self.obeys, self.is_shared = rover.driver == CMD_VEL, False
        self._next = Order()

    def command(self, twist: Twist) -> None:
        """Sets the command from the next control period on (cmd_vel driver)."""
        if self.obeys:
            self.is_shared, self._next = True, self._next.then(Order(command=twist))

    def reset(self) -> int | None:
        """Puts the rover back to its start, as `Episode.reset`; returns when [ns], None for never."""
        return self._by_others(Order(reset=True))

    def put(self, place: Place) -> int | None:
        """Puts the rover somewhere else; all else is as in `reset`."""
        return self._by_others(Order(reset=True, place=place))

    def head_for(self, goal: Place) -> int | None:
        """Gives the driver `goal` its next goal; returns from when on [ns], None for never."""
        return self._by_others(Order(goal=goal))

    def give(self, order: Order) -> int | None:
        """Orders something whatever drives; returns from when on [ns], None for never."""
        at_ns = self._progress.next_ns
        if at_ns is not None:
            self._next = self._next.then(order)
        return at_ns

    def take(self) -> Order | None:
        """Returns the next order, once; None for nothing but to go on."""
        order, self._next = self._next, Order()
        return None if order == Order() else order

    def _by_others(self, order: Order) -> int | None:
        self.is_shared = True
        return self.give(order)


class EpisodeStream:
    """The episodes of a run's rovers, driven as their batches are taken.

    Args:
        run: What is driven.
        frame_options: Which transforms are published; None for none.
        prompt: Whether each order comes into effect with the next batch; else a second core simulates
            ahead of what is consumed, by one batch, or by several where they are asked to `hasten`.
        awake: As `Together` has it.

    Attributes:
        rovers: Take the orders of each rover.
    """

    def __init__(
        self,
        run: Run,
        frame_options: FrameOptions | None = None,
        *,
        prompt: bool = False,
        awake: bool = False,
    ) -> None:
        self._run, self._frame_options = run, frame_options
        self._ahead, self._awake = not prompt, awake
        self._progress = Progress(run.total_periods)
        self.rovers = tuple(RoverOrders(self._progress, rover) for rover in run.rovers)
        self._episodes: tuple[Episode, ...] = ()

    def begin(self) -> "tuple[Episode, ...]":
        """Builds the world; returns the episodes. Called once, first.

        Raises:
            UsageError: As `episodes_of`.
        """
        with loading():
            # Only here: it loads MuJoCo and compiled kernels, and while it does, nodes are discovered.
            from harness.episode.episode import episodes_of  # noqa: PLC0415
        self._episodes = episodes_of(self._run, self._frame_options)
        # Not a method, which would keep the stream, and a world with it, until garbage is collected.
        taken = partial(_taken_orders, self._progress, self._episodes, self.rovers)
        self._together = Together(self._episodes, taken, ahead=self._ahead, awake=self._awake)
        return self._episodes

    @property
    def next_ns(self) -> int | None:
        """The simulation time [ns] from which on the next order holds; None if there is no more."""
        return self._progress.next_ns

    def batches(self) -> Generator[tuple[Batch, ...]]:
        """Returns the batches of each control period, one by one; errors are those of `Together`."""
        return self._together.batches()

    def hasten(self) -> None:
        """Makes the next batches early, as `Together.hasten`, where the two cores wait awake."""
        if self._awake:
            self._together.hasten()


def _taken_orders(
    progress: Progress, episodes: "Sequence[Episode]", rovers: Sequence[RoverOrders]
) -> Callable[[], None] | None:
    """What has been ordered for the next control period; None for nothing but to go on."""
    progress.taken += 1
    orders = [(episode, rover.take()) for episode, rover in zip(episodes, rovers, strict=True)]
    given = [partial(episode.pilot.follow, order) for episode, order in orders if order is not None]

    def act() -> None:
        for each in given:
            each()

    return act if given else None
