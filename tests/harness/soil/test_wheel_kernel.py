"""What a wheel in soil must do whatever the soil's numbers are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.soil.soils import SOILS, Soil
from harness.soil.wheel_kernel import steady_wheels

RADIUS, WIDTH, SPEED = 0.0625, 0.05, 0.01
soils = st.sampled_from([SOILS[name] for name in ("dry_sand", "lll_sand", "clay", "lunar", "firm")])
angles = st.floats(0.0, 75.0)
loads = st.floats(5.0, 40.0)


def drawn(soil: Soil, rim: float, load: float, angle_deg: float = 0.0) -> np.ndarray:
    """Sinkage, forces ahead and left, and moment of a smooth wheel at SPEED."""
    angle, results = np.radians(angle_deg), np.empty((1, 4))
    trial = np.array([[RADIUS, 0.0, rim, SPEED * np.cos(angle), SPEED * np.sin(angle), load]])
    steady_wheels(soil.numbers(WIDTH, 9.81), trial, WIDTH, results)
    return np.asarray(results[0])


@given(soils, loads, angles, st.floats(0.0, 0.1))
def test_a_mirrored_slip_angle_mirrors_the_side_force(
    soil: Soil, load: float, angle: float, rim: float
) -> None:
    one, other = drawn(soil, rim, load, angle), drawn(soil, rim, load, -angle)
    assert one[[0, 1, 3]] == pytest.approx(other[[0, 1, 3]], nan_ok=True)
    assert one[2] == pytest.approx(-other[2], nan_ok=True)


@given(soils, loads, angles, st.floats(0.0, 0.1))
def test_soil_never_drives_a_wheel(soil: Soil, load: float, angle: float, rim: float) -> None:
    _, ahead, left, brake = drawn(soil, rim, load, angle)
    along, across = SPEED * np.cos(np.radians(angle)), SPEED * np.sin(np.radians(angle))
    work = ahead * along + left * across - brake * rim / RADIUS
    assert np.isnan(work) or work <= 1e-9


@given(soils, loads)
def test_a_rolling_wheel_is_resisted_and_a_locked_one_ploughs(soil: Soil, load: float) -> None:
    for rim in (0.0, 0.5 * SPEED, SPEED):
        sinkage, ahead, _, _ = drawn(soil, rim, load)
        assert np.isnan(sinkage) or ahead <= max(
            0.15 * soil.rebound * load, 1e-6
        )  # its rim slips a little


def test_no_load_is_no_force() -> None:
    assert drawn(SOILS["dry_sand"], SPEED, 1e-6) == pytest.approx(np.zeros(4), abs=2e-3)


@pytest.mark.parametrize("name", ["dry_sand", "lll_sand", "clay", "lunar", "firm"])
def test_pull_grows_with_slip_up_to_three_quarters(name: str) -> None:
    pulls = [drawn(SOILS[name], SPEED / (1.0 - slip), 21.0)[1] for slip in np.linspace(0.0, 0.75, 16)]
    assert (np.diff(pulls) > -0.05).all()


def test_hard_soil_pulls_as_friction_does() -> None:
    sinkage, pull, _, _ = drawn(SOILS["firm"], 4.0 * SPEED, 21.0)
    assert sinkage < 1e-3
    assert pull == pytest.approx(21.0, rel=0.05)
