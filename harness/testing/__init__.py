"""Test your own ROS 2 node against a simulated rover: in lock-step, on simulated time, without sleeps.

    from harness import Run
    from harness.testing import Trial

    with Trial(Run.of(terrain="maze", driver="cmd_vel", faults=("scan:dropout@2",))) as trial:
        trial.host(MyNode)
        alarms = trial.collect(Bool, "alarm")
        trial.step(2.0)
        trial.until(lambda: len(alarms) > 0, within=0.5)

With pytest, `pytest_plugins = ["harness.testing.plugin"]` gives the fixture `start_trial`.
"""

from harness.testing.subject import Heard
from harness.testing.trial import Trial

__all__ = ["Heard", "Trial"]
