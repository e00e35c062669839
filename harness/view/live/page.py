"""The page: a server in this process, and a thread that draws at its own pace."""

import errno
import importlib.util
import os
import time
from contextlib import AbstractContextManager, ExitStack
from functools import partial
from threading import Event, Thread
from typing import TYPE_CHECKING

from harness.base.errors import UsageError
from harness.episode.helm import Helm
from harness.samples import Place
from harness.spec.live import HERE, PORT, LiveOptions, address_of
from harness.spec.run import Run
from harness.view.live.gate import Gate
from harness.view.live.watch import Watch
from rover_metrics.errors import complain

if TYPE_CHECKING:
    from harness.view.live.recording import Player

FRAME, SLOWLY = 0.04, 0.25  # [s] of wall time between two frames; between two of charts and paths
PATIENCE = 5.0  # [s] for the last frame to be drawn


class LivePage(AbstractContextManager["LivePage"]):
    """Serves a run until it is left; nobody who watches, however slowly, holds the run up.

    Args:
        run: What is shown.
        helm: Gets what is ordered on the page.
        options: Where it is served.
        steered: Whether rovers take orders, and there is a log with thresholds.
        player: Of a recording, whose time has a slider; None for a run that goes on.

    Attributes:
        address: What a browser opens.
        observers: Must see the batches of each rover.

    Raises:
        UsageError: viser is missing, or it cannot be served there.
    """

    def __init__(
        self,
        run: Run,
        helm: Helm,
        options: LiveOptions,
        *,
        steered: bool = True,
        player: "Player | None" = None,
    ) -> None:
        if importlib.util.find_spec("viser") is None:
            raise UsageError("--live needs viser; install it with pip install 'rover-harness[live]'")
        from harness.view.live.panel import Panel  # noqa: PLC0415 - its extra may be missing
        from harness.view.live.server import Server  # noqa: PLC0415
        from harness.view.live.stage import Stage  # noqa: PLC0415

        host, port = address_of(options.live or "")
        self.observers = [Watch(partial(helm.last_row, number)) for number in range(len(run.rovers))]
        guarded = options.live_token or host != HERE
        with ExitStack() as opened:
            self._server = Server(HERE, 0 if guarded else port)
            opened.callback(self._server.stop)
            own = self._server.get_port()
            if guarded:
                opened.enter_context(Gate(host, port, options.live_token, own))
            elif port not in (PORT, own):  # somebody waits there, e.g. behind an ssh -L
                raise UsageError(
                    f"--live {host}:{port} cannot be served: {os.strerror(errno.EADDRINUSE)}; "
                    f"name another port, e.g. --live :{own}"
                )
            self._stage = Stage(self._server.scene, run)
            self._stage.aim(self._server.initial_camera)
            parts = self._server, run, helm, self._stage, self.observers
            self._panel = Panel(*parts, steered=steered, player=player)
            self._at_end = opened.pop_all()
        shown = f"[{host}]" if ":" in host else host
        self.address = f"http://{shown}:{port if guarded else own}"
        self.address += f"/?token={options.live_token}" if options.live_token else ""
        self._ended, self._failed = Event(), False
        self._drawing = Thread(target=self._draw, name="live page", daemon=True)
        self._drawing.start()

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Serves it no longer."""
        self._ended.set()
        self._drawing.join(PATIENCE)
        self._at_end.close()

    def mark(self, goal: Place) -> None:
        """Shows a goal."""
        self._stage.mark(goal)

    def _draw(self) -> None:
        slowly, versions = 0.0, None
        while not self._ended.wait(FRAME):
            self._panel.let_go()
            if not self._server.get_clients():
                versions = None  # a new client sees everything, also of a run that is paused
                continue
            latest = [watch.version for watch in self.observers]
            is_due = time.monotonic() - slowly >= SLOWLY
            try:
                self._draw_frame(moved=latest != versions, slow=is_due)
            except Exception as error:  # noqa: BLE001 - keys must be let go of even so
                self._complain(error)
            slowly = time.monotonic() if is_due else slowly
            versions = latest

    def _draw_frame(self, *, moved: bool, slow: bool) -> None:
        with self._server.atomic():
            if moved:
                self._stage.draw(self.observers)
            if slow:
                self._stage.draw_paths(self.observers)
                self._panel.show()

    def _complain(self, error: Exception) -> None:
        if not self._failed:
            complain("harness.live", f"the page shows no more than this: {error!r}")
        self._failed = True
