"""Processes that are forked from one that has imported all they need: imports take 1.5 s."""

import multiprocessing
from multiprocessing import forkserver, util
from multiprocessing.context import ForkServerContext

_LOADED = "tests.support.loaded"

util.get_temp_dir()  # of the server's socket: made before a test says where such are made


class ForkServer:
    """Stands where a module looks for `multiprocessing`: its children are a fork server's."""

    def get_context(self, method: str) -> ForkServerContext:
        """The fork server's context, the server running: as it starts, no signal may be held back."""
        assert method == "spawn"
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload([_LOADED])
        forkserver.ensure_running()
        return context
