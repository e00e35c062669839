"""The driver that is driven: a human, Nav2 or an RL agent over /cmd_vel."""

from typing import ClassVar

from harness.drivers.base import DriverContext, Observation
from harness.samples import Twist


class CmdVel:
    """Repeats the last command received; stands still before the first.

    As in Gazebo's DiffDrive a command holds until the next one.
    """

    summary: ClassVar[str] = "listens to /cmd_vel (geometry_msgs/Twist)"

    def __init__(self, context: DriverContext) -> None:  # noqa: ARG002 - any rover, any map
        self.latest = Twist()

    def command(self, observation: Observation) -> Twist:  # noqa: ARG002 - somebody else observes
        """The command in force."""
        return self.latest
