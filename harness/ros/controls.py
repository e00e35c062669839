"""The services of the node `harness` that act on a run: ~/reset and ~/pause.

Their callbacks run wherever the executor spins, in the midst of a tick: they only take note. What they
ask for happens between two ticks (pause) or with a batch to come (reset).
"""

import time
from collections.abc import Callable, Sequence
from functools import partial

from std_srvs.srv import SetBool, Trigger

from harness.base.interrupt import StopRequest
from harness.base.sim_time import NANOSECONDS
from harness.ros.bridge import Bridge
from harness.ros.context import SPIN_TIMEOUT

Reset = Callable[[], int | None]


class Controls:
    """Offers both services, for each rover of a world: each is reset by itself, a pause is of all.

    Args:
        rovers: The bridge of each rover, the first of which an executor spins, and what puts the rover
            back: it returns the simulation time [ns] at which that happens, None if the run ends before.

    Attributes:
        held_s: Wall time for which the run was paused [s].
    """

    def __init__(self, rovers: Sequence[tuple[Bridge, Reset]]) -> None:
        self._bridge = rovers[0][0]
        self._paused = False
        self.held_s = 0.0
        for node, put_back in rovers:
            node.create_service(Trigger, "~/reset", partial(self._answer_reset, put_back))
            node.create_service(SetBool, "~/pause", self._answer_pause)

    def hold(self, stop: StopRequest) -> float:
        """Returns when the run may go on, or shall stop, and how long that took [s].

        Meanwhile services, this node's parameters and those of hosted nodes are served.
        """
        if not self._paused:
            return 0.0
        began = time.monotonic()
        while self._paused and stop.signal is None:
            self._bridge.executor.spin_once(timeout_sec=SPIN_TIMEOUT)
        held = time.monotonic() - began
        self.held_s += held
        return held

    def _answer_reset(
        self, reset: Reset, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        at_ns = reset()
        late = f"not reset at t = {self._now()}: the run ends before it would come into effect"
        at = f"{(at_ns or 0) / NANOSECONDS:.2f} s"
        response.success = at_ns is not None
        response.message = late if at_ns is None else f"the rover goes back to its start at t = {at}"
        return response

    def _answer_pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        was, self._paused = self._paused, request.data
        on, off = ("paused", "paused already"), ("was not paused", "goes on")
        said = (on if self._paused else off)[was]
        response.success, response.message = True, f"{said} at t = {self._now()}"
        return response

    def _now(self) -> str:
        return f"{self._bridge.time_ns / NANOSECONDS:.2f} s"
