"""Tests of the emergency stop against a simulated rover: pytest examples."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from emergency_stop import EmergencyStop
from std_msgs.msg import Bool

from harness.spec.run import Run
from harness.testing import Trial

Start = Callable[[Run], Trial]
NODE = Path(__file__).with_name("emergency_stop.py")


def towards_a_wall(*faults: str) -> Run:
    """A wall stands 3.2 m ahead of the rover."""
    return Run.of(terrain="maze", seed=8, driver="cmd_vel", duration=20.0, faults=faults)


def test_rover_stops_before_the_wall(start_trial: Start) -> None:
    trial = start_trial(towards_a_wall())
    trial.host(EmergencyStop)
    alarms = trial.collect(Bool, "emergency_stop")
    trial.drive(0.4)
    trial.until(lambda: len(alarms) > 0, within=10.0)
    trial.until(lambda: abs(trial.speed) < 0.01, within=0.5)
    trial.step(1.0)
    assert trial.truth.hazard_contacts == 0
    assert len(alarms) == 1


@pytest.mark.parametrize("fault", ["scan:dropout@2", "scan:nan@2", "scan:empty@2"])
def test_blind_rover_stops_within_half_a_second(fault: str, start_trial: Start) -> None:
    trial = start_trial(towards_a_wall(fault))
    trial.host(EmergencyStop)
    alarms = trial.collect(Bool, "emergency_stop")
    trial.drive(0.4)
    trial.step(1.99)
    assert len(alarms) == 0
    trial.until(lambda: len(alarms) > 0, within=0.5)
    trial.until(lambda: abs(trial.speed) < 0.01, within=0.5)


def test_program_behaves_as_the_class(start_trial: Start) -> None:
    trial = start_trial(towards_a_wall("scan:dropout@1"))
    command = [sys.executable, str(NODE), "--ros-args", "-p", "use_sim_time:=true"]
    trial.launch(command, node="/emergency_stop")
    alarms = trial.collect(Bool, "emergency_stop")
    trial.until(lambda: len(alarms) > 0, within=1.5)
    assert 1.0 < alarms.times[0] < 1.5
