"""What happens in a run: its route, and what comes at stated times: commands, goals, resets, breaks."""

from typing import Annotated

from pydantic import Field

from harness.spec.route import FORM, RouteText
from harness.spec.value import Finite, Length, Option, Seconds, Value


class Plan(Value):
    """A mission and events of a run by simulated time [s], for every rover whose driver heeds them.

    Attributes:
        drivers: Time and name of the driver that drives from then on; "" for the rover's own.
        commands: To the driver cmd_vel: time, forward speed [m/s], yaw rate [rad/s].
        goals: To the driver goal or a policy: time, x, y [m], yaw [rad] in the world.
        resets: Times at which the rovers are put back to their starts.
        aborts: Times from which on the rovers stand still, whatever their drivers want.
        resumes: Times from which on they drive again.
        link_losses: Time and length [s]: meanwhile no command reaches the rovers.
    """

    route: Annotated[RouteText | None, Option("POINTS")] = Field(
        default=None,
        description=f"way points, {FORM}; keys: radius [m], within [s] for each, order=any, limit [s] "
        "for all (docs/missions.md); default: none",
    )
    drivers: tuple[tuple[Seconds, str], ...] = ()
    commands: tuple[tuple[Seconds, Finite, Finite], ...] = ()
    goals: tuple[tuple[Seconds, Finite, Finite, Finite], ...] = ()
    resets: tuple[Seconds, ...] = ()
    aborts: tuple[Seconds, ...] = ()
    resumes: tuple[Seconds, ...] = ()
    link_losses: tuple[tuple[Seconds, Length], ...] = ()

    @property
    def times(self) -> tuple[float, ...]:
        """Returns the times of all events [s]."""
        timed = (*self.drivers, *self.commands, *self.goals, *self.link_losses)
        return (*(float(event[0]) for event in timed), *self.resets, *self.aborts, *self.resumes)
