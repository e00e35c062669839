"""A viser server that keeps off the terminal, and opens no way in from elsewhere."""

import contextlib
import io

import viser


class Server(viser.ViserServer):
    """Serves a page to everybody who reaches the host, on the first free port from the given one on."""

    def __init__(self, host: str, port: int) -> None:
        with contextlib.redirect_stdout(io.StringIO()):
            super().__init__(host, port, label="rover", verbose=False)
        self.gui.configure_theme(control_width="medium", show_logo=False, show_share_button=False)

    def request_share_url(self, verbose: bool = True) -> str | None:  # noqa: ARG002 - viser's
        """Opens no tunnel, which a browser could ask for."""
        return None

    def stop(self) -> None:
        """Ends it, with browsers open or not."""
        with contextlib.redirect_stdout(io.StringIO()):
            super().stop()
