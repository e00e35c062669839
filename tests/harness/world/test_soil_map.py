"""Files that say which soil lies where: what stands beside them, and what strangers put there."""

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from harness.base.errors import UsageError
from harness.soil.soils import SOILS
from harness.world.heightfield import Heightfield
from harness.world.soil_map import Soils, soil_files, soils_on

OWN = "k_phi: 1.5e6\nn: 1.1\nfriction_angle_deg: 28\nshear_length: 0.01\n"
GROUND = Heightfield(np.zeros((30, 40)), 0.5)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """One with a map and a soil of its own; the working folder is another."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    (tmp_path / "own.yaml").write_text(OWN)
    values = OWN.strip().replace(": ", "=").replace("\n", ", ")
    (tmp_path / "own.py").write_text(f"from harness.soil.soils import Soil\nMUD = Soil({values})\n")
    patches = np.zeros((30, 40), np.uint8)
    patches[:5] = 1
    np.save(tmp_path / "map.npy", patches)
    Image.fromarray(patches).save(tmp_path / "map.png")
    return tmp_path


@pytest.mark.parametrize(
    ("name", "own"), [("map.npy", "own.yaml"), ("map.png", "own.yaml"), ("map.npy", "own.py:MUD")]
)
def test_a_map_and_its_soils_are_found_beside_their_file(folder: Path, name: str, own: str) -> None:
    file = folder / "soils.yaml"
    file.write_text(f"soils: [firm, {own}]\nmap: {name}\n")
    soils = soils_on(str(file), GROUND, "flat")
    assert soils.kinds[0] == SOILS["firm"]
    assert soils.kinds[1].k_phi == 1.5e6
    assert (soils.patches[-5:] == 1).all()  # north is up
    assert (soils.patches[:-5] == 0).all()
    assert set(soil_files(str(file))) == {file, folder / own.partition(":")[0], folder / name}


def test_what_is_no_map_is_one_line(folder: Path) -> None:
    os.mkfifo(folder / "pipe.png")
    (folder / "folder.npy").mkdir()
    with (folder / "huge.npy").open("wb") as file:
        file.truncate(2**33)
    Image.new("1", (14000, 14000)).save(folder / "large.png")
    for soils, name, told in (
        ("firm, own.yaml", None, "soils.yaml: key 'map' is missing"),
        (None, "map.npy", "soils.yaml: key 'soils' is missing"),
        ("own.yaml, clay", "pipe.png", "pipe.png: .* a device or a pipe"),
        ("own.yaml, clay", "folder.npy", "folder.npy: Is a directory"),
        ("own.yaml, clay", "huge.npy", "huge.npy: larger than"),
        ("own.yaml, clay", "large.png", "large.png cannot be read: Image size"),
        ("elsewhere/own.yaml, clay", "map.png", "elsewhere/own.yaml: No such file"),
    ):
        lines = [f"soils: [{soils}]\n" if soils else "", f"map: {name}\n" if name else ""]
        (folder / "soils.yaml").write_text("".join(lines))
        with pytest.raises(UsageError, match=told):
            soils_on(str(folder / "soils.yaml"), GROUND, "flat")


def test_stiffer_soil_is_stiffer_under_and_beside_a_wheel() -> None:
    sand = SOILS["dry_sand"]
    assert sand.side_modulus is not None
    (stiff,) = Soils((sand,), np.zeros((1, 1), np.uint8)).but(2.0, 1.0).kinds
    assert (stiff.side_modulus, stiff.k_phi) == (2 * sand.side_modulus, 2 * sand.k_phi)
