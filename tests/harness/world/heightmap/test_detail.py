"""Detail below a heightmap's cells: the spectrum that the standard states, and which random numbers."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.spec.value import made
from harness.spec.world import WorldSpec
from harness.world.files import check_terrain, file_world
from harness.world.world import RoverNeeds, World

LEVEL_E, N_0, HIGHEST = 4096e-6, 0.1, 2.83  # [m^3], [cycles/m] of ISO 8608:2016
COARSE, FINE = 1.0, 0.05  # [m]


def world_of(folder: Path, *, seed: int = 0, size: float = 40.0, **fields: Any) -> World:  # noqa: ANN401
    np.save(folder / "flat.npy", np.zeros((41, 41), np.float32))
    spec = {"terrain": str(folder / "flat.npy"), "terrain_size": size, "terrain_roughness": "E"}
    return file_world(made(WorldSpec, spec | fields), RoverNeeds(wheel_radius=0.06), seed)


def test_profiles_have_the_density_of_the_class_and_the_surface_its_variance(tmp_path: Path) -> None:
    heights = world_of(tmp_path).ground.heights
    count = heights.shape[1]
    assert count == round(40.0 / FINE) + 1
    frequency = np.fft.rfftfreq(count, FINE)
    for profiles in (heights, heights.T):
        spectra = np.abs(np.fft.rfft(profiles - profiles.mean(), axis=1)) ** 2
        density = 2.0 * FINE / count * spectra.mean(axis=0)
        band = (frequency > 1.0) & (frequency < 2.0)
        stated = LEVEL_E * (frequency[band] / N_0) ** -2 * np.sqrt(1 - (frequency[band] / HIGHEST) ** 2)
        assert density[band].mean() == pytest.approx(stated.mean(), rel=0.1)
    longest, shortest = 2 * COARSE, 1 / HIGHEST
    variance = 0.5 * math.pi * LEVEL_E * N_0**2 * (longest - shortest)
    assert heights.std() == pytest.approx(math.sqrt(variance), rel=0.02)


def test_a_class_has_twice_the_heights_of_the_one_before_and_a_seed_its_own(tmp_path: Path) -> None:
    rough, rougher = (world_of(tmp_path, terrain_roughness=name).ground.heights for name in "EF")
    assert np.ptp(rougher) == pytest.approx(2 * np.ptp(rough), abs=1e-3)
    assert np.array_equal(world_of(tmp_path).ground.heights, rough)
    assert not np.allclose(world_of(tmp_path, seed=1).ground.heights, rough, atol=1e-3)


def test_what_was_added_and_that_nothing_could_be_is_told(tmp_path: Path) -> None:
    told = "\n".join(world_of(tmp_path).notes)
    assert "class E below 2 m" in told
    assert "coarser" not in told
    wide = "\n".join(world_of(tmp_path, size=4000.0, terrain_roughness="A").notes)
    assert "in cells of 2.7" in wide  # 1500 x 1500 of them
    assert "coarser than the wheels" in wide
    fine = world_of(tmp_path, size=10.0, terrain_roughness="A", terrain_height=None)
    assert fine.ground.cell == pytest.approx(0.25 / 5)
    with pytest.raises(UsageError, match="--terrain-roughness applies to heightmaps only"):
        check_terrain(WorldSpec(terrain="rocky", terrain_roughness="C"))
    with pytest.raises(UsageError, match="terrain_roughness 'I' is not valid; give one of"):
        world_of(tmp_path, terrain_roughness="I")
