"""What happens in a run at stated times: commands, goals, resets."""

from harness.spec.value import Finite, Seconds, Value


class Plan(Value):
    """Events of a run by simulated time [s], for every rover whose driver heeds them.

    Attributes:
        commands: To the driver cmd_vel: time, forward speed [m/s], yaw rate [rad/s].
        goals: To the driver goal or a policy: time, x, y [m], yaw [rad] in the world.
        resets: Times at which the rovers are put back to their starts.
    """

    commands: tuple[tuple[Seconds, Finite, Finite], ...] = ()
    goals: tuple[tuple[Seconds, Finite, Finite, Finite], ...] = ()
    resets: tuple[Seconds, ...] = ()

    @property
    def times(self) -> tuple[float, ...]:
        """Returns the times of all events [s]."""
        return (*(event[0] for event in (*self.commands, *self.goals)), *self.resets)
