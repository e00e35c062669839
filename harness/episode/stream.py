"""An episode in a child process: simulation on one core, its consumer (ROS) on the other.

The child simulates AHEAD batches ahead, so the consumer hardly waits for physics nor physics for the
consumer; the stream itself is the episode's, bit for bit. Each batch has an order: the consumer sends
one for each that it has taken, so what it orders comes into effect after the batches that are ordered
already, at a time that it knows. With the cmd_vel driver the child waits for each command instead.

The child sends the episode's info and description, its batches and None, or instead of any of these
the error that it failed of.
"""

import contextlib
import multiprocessing
import traceback
from collections.abc import Iterator
from multiprocessing.connection import Connection
from typing import Any, NamedTuple, Self

from harness.config import EpisodeConfig
from harness.drivers.base import CONTROL_PERIOD_NS
from harness.episode.batch import Batch, EpisodeInfo
from harness.errors import HarnessError, RunFailed
from harness.frames.options import FrameOptions
from harness.frames.tree import Description
from harness.interrupt import held_back
from harness.samples import Place, Twist
from harness.world.terrain_file import is_terrain_file
from harness.world.world import World

AHEAD = 10  # batches: 0.5 s of simulated time
EXIT_PATIENCE = 0.5  # [s] for the child to leave before it is killed


class _Order(NamedTuple):
    """What a batch begins with, in this order, that is not just the next one.

    Attributes:
        reset: Whether the rover goes back to its start, or to `place`.
        command: Of the driver cmd_vel.
        goal: Of the driver goal.
    """

    reset: bool = False
    place: Place | None = None
    command: Twist | None = None
    goal: Place | None = None


class EpisodeProcess:
    """Runs an episode in a child; a context manager that leaves no process behind."""

    def __init__(self, config: EpisodeConfig, frame_options: FrameOptions | None = None) -> None:
        self._config = config
        self._describes = frame_options is not None
        self._obeys = config.driver == "cmd_vel"
        world = _built_world(config)
        context = multiprocessing.get_context("spawn")
        self._connection, remote = context.Pipe()
        self._process = context.Process(
            target=_simulate, args=(config, frame_options, remote, world), daemon=True
        )
        try:
            with held_back():
                self._process.start()
        except BaseException:  # a signal arrived meanwhile, and nobody will leave this context
            if self._process.pid is not None:
                self._process.kill()
                self._process.join()
            raise
        remote.close()
        self._next = _Order()
        self._ordered = 0
        for _ in range(0 if self._obeys else AHEAD):
            self._order()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._connection.close()
        self._process.join(EXIT_PATIENCE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()

    @property
    def info(self) -> EpisodeInfo:
        """What the episode was made of; waits until the world is built. Ask once, first."""
        info: EpisodeInfo = self._receive()
        return info

    @property
    def description(self) -> Description | None:
        """What its transforms are of; None without any. Ask once, second."""
        return self._receive() if self._describes else None

    def command(self, twist: Twist) -> None:
        """Sets the command from the next control period on (cmd_vel driver)."""
        if self._obeys:
            self._next = self._next._replace(command=twist)

    def reset(self) -> int | None:
        """Puts the rover back to its start, as `Episode.reset`; a command in force is forgotten.

        Returns:
            The simulation time [ns] at which that happens; None if the episode ends before.
        """
        return self._note(_Order(reset=True))

    def put(self, place: Place) -> int | None:
        """Puts the rover somewhere else; all else is as in `reset`."""
        return self._note(_Order(reset=True, place=place))

    def head_for(self, goal: Place) -> int | None:
        """Gives the driver `goal` its next goal.

        Returns:
            The simulation time [ns] from which on it holds; None if the episode ends before.
        """
        return self._note(self._next._replace(goal=goal))

    def batches(self) -> Iterator[Batch]:
        """Yields the episode's batches, in order.

        Raises:
            RunFailed: As `Episode.batches`, or the child died.
        """
        self._order()
        while (batch := self._receive()) is not None:
            yield batch
            self._order()

    def _order(self) -> None:
        if self._ordered == self._config.total_periods:
            return
        order = None if self._next == _Order() else self._next
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):  # the next receipt tells why
            self._connection.send(order)
        self._ordered, self._next = self._ordered + 1, _Order()

    def _note(self, order: _Order) -> int | None:
        """Makes that the next order; returns when it comes into effect."""
        if self._ordered == self._config.total_periods:
            return None
        self._next = order
        return self._ordered * CONTROL_PERIOD_NS

    def _receive(self) -> Any:  # noqa: ANN401 - see the module
        try:
            received = self._connection.recv()
        except (EOFError, ConnectionResetError) as error:
            message = f"the simulation process died (exit code {self._process.exitcode})"
            raise RunFailed(message) from error
        if isinstance(received, Exception):
            raise received
        return received


def _built_world(config: EpisodeConfig) -> World | None:
    """Returns the world of a file, which takes seconds to build and little to hand over; else None.

    Raises:
        UsageError: There is no such world.
    """
    if not is_terrain_file(config.terrain):
        return None
    config.check_world()
    return config.world()


def _simulate(
    config: EpisodeConfig,
    frame_options: FrameOptions | None,
    connection: Connection,
    world: World | None,
) -> None:
    """The child: builds the episode, then streams it until its end or until nobody listens."""
    with contextlib.suppress(BrokenPipeError, ConnectionResetError, EOFError):
        try:
            _stream(config, frame_options, connection, world)
        except HarnessError as error:
            connection.send(error)
        except Exception:  # noqa: BLE001 - a bug: its trace must reach the parent
            trace = traceback.format_exc()
            connection.send(RuntimeError(f"the simulation process failed:\n{trace}"))


def _stream(
    config: EpisodeConfig,
    frame_options: FrameOptions | None,
    connection: Connection,
    world: World | None,
) -> None:
    # Only here: it loads MuJoCo and compiled kernels, which the parent does without.
    from harness.episode.episode import Episode  # noqa: PLC0415

    episode = Episode(config, frame_options, world=world)
    connection.send(episode.info)
    if episode.description is not None:
        connection.send(episode.description)
    batches = episode.batches()
    for _ in range(config.total_periods):
        order: _Order | None = connection.recv()
        if order is not None and order.reset:
            episode.reset(order.place)
        if order is not None and order.command is not None:
            episode.command(order.command)
        if order is not None and order.goal is not None:
            episode.head_for(order.goal)
        connection.send(next(batches))
    next(batches, None)  # raises what the last of them failed of
    connection.send(None)
