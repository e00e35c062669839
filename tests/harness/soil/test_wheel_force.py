"""What a wheel in soil must do whatever the soil's numbers are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.soil.rig_kernel import steady_wheels
from harness.soil.soils import SOILS, Soil
from harness.soil.wheel_force import STATE, wheel_force
from tests.support.kernels import compiled

RADIUS, WIDTH, SPEED = 0.0625, 0.05, 0.01
soils = st.sampled_from([SOILS[name] for name in ("dry_sand", "lll_sand", "clay", "lunar", "firm")])
angles = st.floats(0.0, 75.0)
loads = st.floats(5.0, 40.0)


def drawn(
    soil: Soil,
    rim: float,
    load: float,
    angle_deg: float = 0.0,
    *,
    speed: float = SPEED,
    grousers: float = 0.0,
) -> np.ndarray:
    """Sinkage, forces ahead and left, and moment of a wheel."""
    angle, results = np.radians(angle_deg), np.empty((1, 5))
    trial = np.array([[RADIUS, grousers, rim, speed * np.cos(angle), speed * np.sin(angle), load]])
    steady_wheels(soil.numbers(WIDTH, 9.81), trial, WIDTH, results)
    return np.asarray(results[0, :4])


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


@pytest.mark.parametrize("name", ["dry_sand", "lll_sand", "clay", "lunar", "firm"])
def test_pull_grows_with_slip_up_to_three_quarters(name: str) -> None:
    pulls = [drawn(SOILS[name], SPEED / (1.0 - slip), 21.0)[1] for slip in np.linspace(0.0, 0.75, 16)]
    assert (np.diff(pulls) > -0.05).all()


@given(st.floats(10.0, 45.0), loads, st.floats(0.5, 0.9))
def test_hard_soil_pulls_as_friction_does(angle_deg: float, load: float, slip: float) -> None:
    hard = SOILS["firm"].model_copy(
        update={"friction_angle_deg": angle_deg, "k_phi": 1e9, "shear_length": 1e-5}
    )
    sinkage, pull, _, _ = drawn(hard, SPEED / (1.0 - slip), load)
    assert sinkage < 1e-3
    assert pull == pytest.approx(load * np.tan(np.radians(angle_deg)), rel=0.05)


def test_a_wheel_that_spins_on_the_spot_digs_in_to_a_limit() -> None:
    for grousers in (0.0, 1.0):
        sinkage, _, _, _ = drawn(SOILS["dry_sand"], 0.1, 21.0, speed=1e-5, grousers=grousers)
        assert 0.02 < sinkage < 1.4 * RADIUS
    assert drawn(SOILS["dry_sand"], 0.1, 21.0, speed=1e-5)[0] < sinkage  # grousers dig deeper


@given(soils, st.integers(0, 2**32 - 1))
@settings(max_examples=12, deadline=None)
def test_soil_gives_no_energy_over_a_closed_motion(soil: Soil, seed: int) -> None:
    rng, state, dt = np.random.default_rng(seed), np.zeros(STATE), 0.0025
    swings = rng.uniform(-1.0, 1.0, (4, 3)) * np.array([[0.3], [0.3], [0.1], [0.05]])
    phases, size = rng.uniform(0.0, 2.0 * np.pi, (4, 3)), (RADIUS, WIDTH, float(rng.integers(2)))
    work, h, numbers = [0.0, 0.0], rng.uniform(0.0, 0.02), soil.numbers(WIDTH, 9.81)
    turned = 2.0 * np.pi * np.arange(0.0, 1.0, dt)[:, None, None] * np.arange(1, 4) + phases
    motions = (swings * np.sin(turned)).sum(axis=2).tolist()
    for cycle in range(2):
        for u, vx, vy, vz in motions:
            h -= vz * dt
            motion = (u, vx, vy, vz)
            ahead, left, up, brake, _ = compiled(wheel_force)(
                numbers, size, (h, 0.0), (h, 0.0), motion, state, dt
            )
            work[cycle] += (ahead * vx + left * vy + up * vz - brake * u / RADIUS) * dt
    assert work[1] <= 1e-6
