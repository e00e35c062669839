import math

import numpy as np
import pytest

from harness.validate.grounds import block, floor
from harness.validate.rig import Rig, largest_passing
from tests.support.rovers import LEO


def test_bisection_finds_the_last_step_that_passes() -> None:
    assert largest_passing(lambda height: height < 0.0721, 0.03, 0.14, 0.005) == pytest.approx(0.070)
    assert math.isnan(largest_passing(lambda _: False, 1, 9, 1))
    assert largest_passing(lambda _: True, 1, 9, 1) == 9


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_rover_drives_ahead_on_whatever_heading_it_was_set_down(seed: int) -> None:
    rig = Rig(LEO, floor(seed, block("cylinder", (0.1, 0.2), x=1.6)))
    model, forward = rig.simulation.model, rig.simulation.position + np.array([0.0, 0.0, 1.0])
    assert (rig.stance.ahead, rig.stance.aside) == pytest.approx((0.0, 0.0), abs=5e-3)
    assert rig.in_model_frame(forward) == pytest.approx((0.0, 0.0, 1.0), abs=0.01)
    assert all(rig.stands_on([geom]) for geom in rig.wheel_geoms)
    assert not rig.stands_on([g for g in range(model.ngeom) if model.geom(g).name.startswith("body_")])
    rig.command(0.4)
    rig.run(2.0)
    assert rig.stance.ahead == pytest.approx(0.4 * 2.0, abs=0.08)
    assert rig.stance.aside == pytest.approx(0.0, abs=0.02)
    assert not rig.touches_block
    assert rig.run_until(lambda: rig.touches_block, 3.0)
    assert rig.stance.ahead + LEO.footprint[1] == pytest.approx(1.5, abs=0.1)


def test_turns_are_counted_in_full_and_observers_are_called_every_tick() -> None:
    rig, seen = Rig(LEO, floor(1)), []
    rig.observers.append(lambda: seen.append(rig.stance.yaw))
    start = rig.stance.yaw
    rig.command(0.0, 3.0)

    assert rig.run_until(lambda: rig.stance.yaw - start > 2 * math.pi, 8.0)
    assert np.abs(np.diff(seen)).max() < 0.1
    before = len(seen)
    assert not rig.run_until(lambda: False, 0.1)
    rig.run(0.2)
    assert len(seen) - before == 10 + 20
