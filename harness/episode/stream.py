"""Episodes of one world in a child process: simulation on one core, its consumer (ROS) on the other.

The child simulates AHEAD batches ahead, so the consumer hardly waits for physics nor physics for the
consumer; the stream is the episodes', bit for bit. Each batch has an order per rover: the consumer
sends them for each batch that it has taken, so what it orders comes into effect after those that are
ordered already, at a time that it knows. With the cmd_vel driver the child waits for each command
instead.

The child sends what the episodes were made of, then batches, TOGETHER in one message since each wakes
the consumer, and an empty message at the end, or instead of any of these the error by which it failed.
"""

import contextlib
import multiprocessing
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from multiprocessing.connection import Connection
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

from harness.base.edge import loading
from harness.base.errors import HarnessError, RunFailed
from harness.base.interrupt import held_back
from harness.base.sim_time import CONTROL_PERIOD_NS
from harness.episode.assembly import check_world, world_of
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.helm import Order, follow
from harness.frames.tree import Description
from harness.samples import Place, Twist
from harness.spec.ros import FrameOptions
from harness.spec.rover import CMD_VEL, RoverSetup
from harness.spec.run import Run
from harness.world.files import is_terrain_file
from harness.world.world import World

if TYPE_CHECKING:
    from harness.episode.episode import Episode

AHEAD = 10  # batches: 0.5 s of simulated time
TOGETHER = 5  # no more than AHEAD, or both would wait
EXIT_PATIENCE = 0.5  # [s] for the child to leave before it is killed


class Begun(NamedTuple):
    """What one rover's episode was made of; `description` is of its transforms, None without any."""

    info: EpisodeInfo
    description: Description | None


class RoverOrders:
    """What the consumer orders of one rover.

    Attributes:
        obeys: Whether its driver takes commands.
        is_shared: Whether anything was ordered otherwise than by `give`.
    """

    def __init__(self, process: "EpisodeProcess", rover: RoverSetup) -> None:
        self._process = process
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
        at_ns = self._process.next_ns
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


class EpisodeProcess(contextlib.AbstractContextManager["EpisodeProcess"]):
    """Runs the episodes of a world in a child; a context manager that leaves no process behind.

    Its `rovers` take the orders, in that order.

    Args:
        run: What is driven.
        frame_options: Which transforms are published; None for none.
        prompt: Whether each order comes into effect with the next batch, and nothing is simulated ahead.
    """

    def __init__(
        self, run: Run, frame_options: FrameOptions | None = None, *, prompt: bool = False
    ) -> None:
        prompt = prompt or any(rover.driver == CMD_VEL for rover in run.rovers)
        self._periods = run.total_periods
        world = _built_world(run)
        context = multiprocessing.get_context("spawn")
        self._connection, remote = context.Pipe()
        self._process = context.Process(
            target=_simulate, args=(remote, run, frame_options, world, prompt), daemon=True
        )
        try:
            with held_back(), _nothing_of_the_program():
                self._process.start()
        except BaseException:  # a signal arrived meanwhile, and nobody will leave this context
            if self._process.pid is not None:
                self._process.kill()
                self._process.join()
            raise
        remote.close()
        self.rovers = tuple(RoverOrders(self, rover) for rover in run.rovers)
        self._ordered = 0
        for _ in range(0 if prompt else AHEAD):
            self._order()

    def __exit__(self, *_: object) -> None:
        self._connection.close()
        self._process.join(EXIT_PATIENCE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()

    def begin(self) -> tuple[Begun, ...]:
        """Waits until the world is built; returns what each episode was made of. Called once, first."""
        begun: tuple[Begun, ...] = self._receive()
        return begun

    @property
    def next_ns(self) -> int | None:
        """The simulation time [ns] from which on the next order holds; None if there is no more."""
        return None if self._ordered == self._periods else self._ordered * CONTROL_PERIOD_NS

    def batches(self) -> Iterator[tuple[Batch, ...]]:
        """Yields the batches of each control period; RunFailed as `together`, or if the child died."""
        self._order()
        while received := self._receive():
            for batches in received:
                yield batches
                self._order()

    def _order(self) -> None:
        if self.next_ns is None:
            return
        orders = tuple(rover.take() for rover in self.rovers)
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):  # the next receipt says why
            self._connection.send(orders)
        self._ordered += 1

    def _receive(self) -> Any:  # noqa: ANN401 - see the module
        try:
            received = self._connection.recv()
        except (EOFError, ConnectionResetError) as error:
            message = f"the simulation process died (exit code {self._process.exitcode})"
            raise RunFailed(message) from error
        if isinstance(received, Exception):
            raise received
        return received


@contextlib.contextmanager
def _nothing_of_the_program() -> Iterator[None]:
    """Keeps the child from importing the program's main module again, which takes as long as its own."""
    program, sys.modules["__main__"] = sys.modules["__main__"], ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = program


def _built_world(run: Run) -> World | None:
    """Returns the world of a file, which takes seconds to build and little to hand over; else None."""
    if not is_terrain_file(run.world.terrain):
        return None
    check_world(run)
    return world_of(run)


def _simulate(connection: Connection, *of: Any) -> None:  # noqa: ANN401 - arguments of _stream
    """The child: builds the episodes, then streams them until their end or until nobody listens."""
    with contextlib.suppress(BrokenPipeError, ConnectionResetError, EOFError):
        try:
            _stream(connection, *of)
        except HarnessError as error:
            connection.send(error)
        except Exception:  # noqa: BLE001 - a bug: its trace must reach the parent
            trace = traceback.format_exc()
            connection.send(RuntimeError(f"the simulation process failed:\n{trace}"))


def _stream(
    connection: Connection,
    run: Run,
    frame_options: FrameOptions | None,
    world: World | None,
    prompt: bool,
) -> None:
    with loading():
        # Only here: it loads MuJoCo and compiled kernels, which the parent does without.
        from harness.episode.episode import episodes_of  # noqa: PLC0415
        from harness.episode.together import together  # noqa: PLC0415

        episodes = episodes_of(run, frame_options, world)
    connection.send(tuple(Begun(episode.info, episode.description) for episode in episodes))
    size = 1 if prompt else TOGETHER
    unsent: list[tuple[Batch, ...]] = []
    try:
        for batches in together(episodes, partial(_ordered, connection, episodes), ahead=not prompt):
            unsent.append(batches)
            if len(unsent) == size:
                connection.send(unsent)
                unsent.clear()
    finally:  # the error of an episode comes behind its batches
        if unsent:
            connection.send(unsent)
    connection.send([])


def _ordered(connection: Connection, episodes: Sequence["Episode"]) -> Callable[[], None] | None:
    """Returns what has been ordered for the next control period; None for nothing but to go on."""
    orders: tuple[Order | None, ...] = connection.recv()
    given = [
        (episode, order) for episode, order in zip(episodes, orders, strict=True) if order is not None
    ]

    def act() -> None:
        for episode, order in given:
            follow(episode, order)

    return act if given else None
