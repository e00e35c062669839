"""Draws the cameras' images in a process of its own, which starts when the first one is asked for.

A run loads no OpenGL: it must start where there is none, and what goes wrong in a driver must not end
it. Each kind of OpenGL is tried in a new process, since the first that is loaded stays.
"""

import multiprocessing
import os
from collections.abc import Callable, Mapping, Sequence
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import HarnessError
from harness.base.interrupt import held_back
from harness.base.opengl import backends, keep_opengl_out
from harness.sensors.camera.sensor import CameraOptions, CameraState

if TYPE_CHECKING:
    from multiprocessing.process import BaseProcess

    from harness.physics.berths import Member
    from harness.world.world import World

EXIT_PATIENCE = 0.5  # [s] for the process to leave before it is killed

Scenery = Callable[[], tuple["World", Sequence["Member"]]]


class CameraPainter:
    """Draws for the cameras of a run; a context manager that leaves no process behind.

    Args:
        scenery: Makes the world and its rovers, in the other process; to be pickled.
        cameras: Options of the cameras by name.
        seed: Of the images' noise.
        complain: Called, once, with the reason why there are no images.
    """

    def __init__(
        self,
        scenery: Scenery,
        cameras: Mapping[str, CameraOptions],
        seed: int,
        complain: Callable[[str], object],
    ) -> None:
        self._scenery, self._cameras, self._seed = scenery, dict(cameras), seed
        self._complain = complain
        self._connection: Connection | None = None
        self._process: BaseProcess | None = None
        self._failed = False

    def use(self, scenery: Scenery, seed: int) -> None:
        """Draws another world from the next image on, with another seed of the images' noise."""
        self._stop()
        self._scenery, self._seed = scenery, seed

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    def image(self, state: CameraState) -> NDArray[np.uint8] | None:
        """Returns what the camera of that state sees, (height, width, 3), RGB; None without OpenGL."""
        if self._connection is None and not self._failed:
            self._start()
        if self._connection is None:
            return None
        options = self._cameras[state.sensor]
        try:
            self._connection.send(state)
            pixels = self._connection.recv_bytes()
        except (EOFError, ConnectionResetError, BrokenPipeError):
            self._give_up("the process that draws them has ended")
            return None
        return np.frombuffer(pixels, np.uint8).reshape(options.height, options.width, 3)

    def _start(self) -> None:
        """Starts the process with the first OpenGL that works."""
        reason = ""
        context = multiprocessing.get_context("spawn")
        for kind in backends(keep_opengl_out()):
            self._connection, remote = context.Pipe()
            arguments = (kind, self._scenery, self._cameras, self._seed, remote)
            self._process = context.Process(target=_serve, args=arguments, daemon=True)
            with held_back():
                self._process.start()
            remote.close()
            try:
                answer = self._connection.recv()
            except (EOFError, ConnectionResetError):
                answer = f"{kind} ended its process"
            if answer is None:
                return
            reason = reason or str(answer)
            self._stop()
        self._give_up(reason)

    def _give_up(self, reason: str) -> None:
        self._stop()
        self._failed = True
        self._complain(f"no images of {', '.join(self._cameras)}: {reason}; all else goes on")

    def _stop(self) -> None:
        if self._connection is not None:
            self._connection.close()
        if self._process is not None:
            self._process.join(EXIT_PATIENCE)
            if self._process.is_alive():
                self._process.kill()
                self._process.join()
        self._connection = self._process = None


def _serve(
    kind: str, scenery: Scenery, cameras: Mapping[str, CameraOptions], seed: int, connection: Connection
) -> None:
    """The process: says None when it is ready, else why it is not; then an image for each state."""
    os.environ["MUJOCO_GL"] = "off"  # MuJoCo does not load where what it names is missing
    from harness.physics.opengl import gl_context  # noqa: PLC0415 - loads MuJoCo
    from harness.sensors.camera.renderer import CameraRenderer  # noqa: PLC0415 - loads MuJoCo

    os.environ["MUJOCO_GL"] = kind
    try:
        context = gl_context("a camera", 1, 1)
        world, fleet = scenery()
    except HarnessError as error:
        connection.send(str(error))
        return
    with CameraRenderer(world, fleet, cameras, context, seed) as renderer:
        connection.send(None)
        try:
            while True:
                state: CameraState = connection.recv()
                connection.send_bytes(renderer.image(state.sensor, state).tobytes())
        except (EOFError, ConnectionResetError, BrokenPipeError, KeyboardInterrupt):
            return  # the run is over
