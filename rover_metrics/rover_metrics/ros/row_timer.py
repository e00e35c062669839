"""Fires once per second of ROS time, whatever happens to the clock, and reports what happens to it."""

import time
from collections.abc import Callable

from rclpy.clock import Clock, ClockType, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.timer import Timer

from rover_metrics.errors import is_worth_a_line
from rover_metrics.health.watches import SilenceWatch
from rover_metrics.timing import NANOSECONDS, RowTimes

PERIOD = 1.0  # [s] of ROS time between two rows, and of steady time between two looks at the clock


class RowTimer:
    """A timer on the node's clock that survives resets, jumps and a clock that stands still.

    Args:
        node: Whose clock it is.
        fire: Is called when a row is due.
        tell: Is given a line for the user.

    Attributes:
        stale_after: How long ROS time may stand still before that is reported [s of steady time].
        times: What was due, and how many segments there were.
    """

    def __init__(
        self,
        node: Node,
        fire: Callable[[], None],
        tell: Callable[[str], None],
        stale_after: float,
    ) -> None:
        self.stale_after = stale_after
        self._node, self._fire, self._tell = node, fire, tell
        self._clock = node.get_clock()
        self.times = RowTimes(NANOSECONDS)
        self._silence = SilenceWatch()
        self._timer = node.create_timer(PERIOD, self.on_time)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(PERIOD, lambda: self.look(time.monotonic_ns()), clock=steady)
        ahead, back = (Duration(nanoseconds=sign * self.times.jump_ns) for sign in (1, -1))
        threshold = JumpThreshold(min_forward=ahead, min_backward=back, on_clock_change=False)
        self._jumps = self._clock.create_jump_callback(threshold, post_callback=self._jumped)

    def detach(self) -> None:
        """Lets only `serve` fire the timer, whose period begins anew; call it before the clock starts.

        An executor would be woken for the timer with each time of the clock, by a thread of its own.
        """
        self._node.destroy_timer(self._timer)
        group, context = self._node.default_callback_group, self._node.context
        self._timer = Timer(self.on_time, group, NANOSECONDS, self._clock, context=context)

    def on_time(self) -> None:
        """Fires, if a row is due now."""
        if self.times.is_due(self._clock.now().nanoseconds):
            self._fire()

    def serve(self) -> None:
        """Does now what an executor would do later, after messages that have come meanwhile."""
        if self._timer.is_ready():
            self._timer.handle.call_timer()
            self.on_time()

    def look(self, steady_ns: int) -> None:
        """Looks after the clock; to be called once a second of steady time [ns].

        System time that is set back takes no timer with it: that would wait until the old time.
        """
        wait_ns = self._timer.time_until_next_call() or 0
        if not self._clock.ros_time_is_active and wait_ns > 2 * NANOSECONDS:
            self._timer.reset()
            self._went_back()
        now_ns = self._clock.now().nanoseconds
        change = self._silence.look(now_ns, steady_ns, round(self.stale_after * NANOSECONDS))
        if change is None:
            return
        if change.is_over:
            self._tell(f"ROS time goes on after {change.seconds:.0f} s")
        else:
            self._tell(
                f"ROS time has stood still at {now_ns / 1e9:.2f} s for {change.seconds:.0f} s: no rows "
                "are written; is the simulation paused, or does nobody publish /clock?"
            )

    def close(self) -> None:
        """Listens to the clock no more."""
        self._jumps.unregister()

    def _jumped(self, jump: TimeJump) -> None:
        if jump.delta.nanoseconds < 0:
            self._went_back()
        else:
            self.times.leapt_ahead()

    def _went_back(self) -> None:
        before = self.times.segments
        self.times.went_back()
        if is_worth_a_line(before, self.times.segments):
            self._tell(
                f"the clock went back: segment {self.times.segments} of this log begins, totals go on"
            )
