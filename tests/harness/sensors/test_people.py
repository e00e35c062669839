"""30 samples of people in each second of a clock of 100 ticks."""

from collections.abc import Callable

import numpy as np
import pytest

from harness.physics.simulation import Simulation
from harness.sensors.state import PeopleSensor


def test_people_are_told_of_thirty_times_in_each_second(
    make_simulation: Callable[..., Simulation],
) -> None:
    simulation = make_simulation(actors=("g=1,1/1,-1", "x=0,1"))
    assert simulation.crowd is not None
    sensor = PeopleSensor(simulation, simulation.crowd)
    due = [tick for tick in range(1, 301) if sensor.due(tick)]
    assert len(due) == 90
    assert all(abs(tick / 100 - (n + 1) / 30) < 0.01 for n, tick in enumerate(due))
    simulation.tick()
    told = sensor.read()
    assert told.stamp_ns == simulation.time_ns
    assert np.array(told.position) == pytest.approx(np.array([[1.0, 0.99, 0.875], [0.0, 1.0, 0.875]]))
    half = np.sqrt(0.5)
    assert told.orientation[0] == pytest.approx((0.0, 0.0, -half, half))
