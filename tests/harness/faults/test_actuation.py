"""Faults of commands, against what was commanded and when."""

from unittest.mock import Mock

import numpy as np
import pytest

from harness.base.sim_time import NANOSECONDS
from harness.faults.actuation import ActuatorFaults
from harness.faults.injector import FaultInjector
from harness.faults.lookup import find_faults
from harness.samples import LaserScan, Tick, Twist
from harness.spec.fault import parse_fault
from tests.support.rovers import LEO

PERIOD = 0.05  # [s]


def obeyed(*given: str, count: int = 60) -> np.ndarray:
    """The speeds that are obeyed when each period commands one more [m/s]."""
    faults = ActuatorFaults(find_faults(tuple(map(parse_fault, given)), None), seed=1)
    times = [round(index * PERIOD * NANOSECONDS) for index in range(count)]
    return np.array([faults.command(Twist(float(i)), t).linear for i, t in enumerate(times)])


def test_late_commands_come_in_order_and_none_is_lost() -> None:
    assert obeyed("cmd_vel:latency=0.2") == pytest.approx(np.maximum(np.arange(60) - 4, 0))


@pytest.mark.parametrize("kind", ["freeze", "latency=0.2", "dropout=0.7"])
def test_commands_are_obeyed_before_and_after_the_time_of_a_fault(kind: str) -> None:
    speeds = obeyed(f"cmd_vel:{kind}@1+1")
    assert (speeds[:20] == np.arange(20)).all()
    assert (speeds[20:40] < np.arange(20, 40)).sum() > 5
    assert (speeds[40:] == np.arange(40, 60)).all()
    assert kind != "freeze" or set(speeds[20:40]) == {19.0}


def test_two_faults_of_a_motor_leave_what_either_leaves_of_the_other() -> None:
    told = list[dict[str, float]]()
    simulation = Mock(time_ns=0, limit_motors=lambda strength, _: told.append(strength))
    simulation.scene.rover = LEO
    faults = map(parse_fault, ("motor.left:weak=0.5", "motor.left:weak=0.4", "motor.right:weak=0.3@1"))
    ActuatorFaults(find_faults(tuple(faults), ()), seed=1).act(simulation)
    assert told == [{"left": pytest.approx(0.2), "right": 1.0}]


def test_a_share_of_commands_is_not_heard() -> None:
    both = "scan:dropout=0.3", "cmd_vel:dropout=0.3"
    speeds = obeyed(*both, count=2000)
    heard = speeds == np.arange(2000)
    assert heard.mean() == pytest.approx(0.7, abs=0.05)
    assert (speeds[1:][~heard[1:]] == speeds[:-1][~heard[1:]]).all()
    injector = FaultInjector(find_faults(tuple(map(parse_fault, both)), None), seed=1)
    scan = LaserScan(0, np.ones(3, np.float32))
    seen = [bool(injector.corrupt(Tick(0, (scan,))).samples) for _ in speeds]
    assert np.corrcoef(heard, seen)[0, 1] == pytest.approx(0.0, abs=0.1), "no scan is lost by that"
