"""Faults of commands, against what was commanded and when."""

import numpy as np
import pytest

from harness.base.sim_time import NANOSECONDS
from harness.faults.actuation import ActuatorFaults
from harness.faults.lookup import find_faults
from harness.samples import Twist
from harness.spec.fault import parse_fault

PERIOD = 0.05  # [s]


def obeyed(fault: str, count: int = 60) -> np.ndarray:
    """The speeds that are obeyed when each period commands one more [m/s]."""
    faults = ActuatorFaults(find_faults((parse_fault(fault),), ()), seed=1)
    times = [round(index * PERIOD * NANOSECONDS) for index in range(count)]
    return np.array([faults.command(Twist(float(i)), t).linear for i, t in enumerate(times)])


def test_late_commands_come_in_order_and_none_is_lost() -> None:
    assert obeyed("cmd_vel:latency=0.2") == pytest.approx(np.maximum(np.arange(60) - 4, 0))


def test_frozen_commands_hold_for_as_long_as_the_fault_lasts() -> None:
    speeds = obeyed("cmd_vel:freeze@1+1")
    assert (speeds[:20] == np.arange(20)).all()
    assert set(speeds[20:40]) == {19.0}
    assert (speeds[40:] == np.arange(40, 60)).all()


def test_a_share_of_commands_is_not_heard() -> None:
    speeds = obeyed("cmd_vel:dropout=0.3", 2000)
    heard = speeds == np.arange(2000)
    assert heard.mean() == pytest.approx(0.7, abs=0.05)
    assert (speeds[1:][~heard[1:]] == speeds[:-1][~heard[1:]]).all()
