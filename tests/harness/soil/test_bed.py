"""Rovers on soil: what they feel, what they leave behind, and what stays the same."""

from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.episode.episode import Episode
from harness.spec.run import Run

FORTH = ((0.5, 0.3, 0.0),)
FORTH_AND_BACK = ((0.5, 0.3, 0.0), (5.0, 0.0, 0.0), (5.5, -0.3, 0.0))


def driven(duration: float, **fields: object) -> Episode:
    given = {
        "terrain": "flat",
        "robot": "leo",
        "driver": "cmd_vel",
        "soil": "dry_sand",
        "commands": FORTH,
    }
    episode = Episode(Run.of(duration=duration, **(given | fields)))
    for _ in episode.batches():
        pass
    return episode


@pytest.fixture(scope="module")
def forth() -> Episode:
    return driven(6.0)


def test_the_soil_carries_the_rover_and_keeps_its_volume(forth: Episode) -> None:
    bed = forth.simulation.physics.bed
    assert bed is not None
    weight = float(forth.simulation.model.body_subtreemass[1]) * 9.81
    assert bed.lift.sum() == pytest.approx(weight, rel=0.25)
    assert (bed.felt[:, 0] > 0.002).all()
    heights = bed.surface
    assert heights.min() < -0.003
    assert heights.max() > 0.0005
    assert abs(heights.sum()) < 0.01 * np.abs(heights).sum()


def test_ruts_are_seen_where_the_rover_drove(forth: Episode) -> None:
    simulation = forth.simulation
    x, y = float(simulation.position[0]), float(simulation.position[1])
    axis = np.linspace(-0.6, 0.6, 41)
    behind = simulation.ground.heights_at(x - 0.7 + 0 * axis, y + axis)
    ahead = simulation.ground.heights_at(x + 1.5 + 0 * axis, y + axis)
    assert behind.min() < -0.003
    assert ahead.min() == ahead.max() == 0.0


def test_the_second_pass_is_shallower() -> None:
    def deeper(commands: tuple[tuple[float, float, float], ...], duration: float) -> float:
        bed = driven(duration, commands=commands).simulation.physics.bed
        assert bed is not None
        return float((bed.felt[:, 0] - bed.felt[:, 7]).mean())

    assert deeper(FORTH_AND_BACK, 8.0) < 0.7 * deeper(FORTH, 4.0)


def test_firm_soil_drives_as_rigid_ground() -> None:
    ahead = [driven(6.0, soil=soil).simulation.position[0] for soil in ("firm", "")]
    assert ahead[0] == pytest.approx(ahead[1], rel=0.05)


def test_equal_runs_give_equal_bytes_beside_rocks_and_people() -> None:
    rocky = {"terrain": "rocky", "actors": ("x=3,1",), "driver": "wander", "commands": (), "seed": 5}
    one, other = driven(4.0, **rocky), driven(4.0, **rocky)
    assert one.simulation.data.qpos.tobytes() == other.simulation.data.qpos.tobytes()
    assert one.simulation.physics.bed is not None
    assert other.simulation.physics.bed is not None
    assert one.simulation.physics.bed.surface.tobytes() == other.simulation.physics.bed.surface.tobytes()


def test_an_own_soil_that_is_too_stiff_or_wrong_is_one_line(tmp_path: Path) -> None:
    file = tmp_path / "concrete.yaml"
    file.write_text("k_phi: 1.0e+10\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n")
    with pytest.raises(UsageError, match=r"too stiff .* --timestep"):
        driven(1.0, soil=str(file))
    file.write_text("k_phi: -1\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n")
    with pytest.raises(UsageError, match="k_phi"):
        driven(1.0, soil=str(file))
    with pytest.raises(UsageError, match="dry_sand"):
        driven(1.0, soil="mud")
