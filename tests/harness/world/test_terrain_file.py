"""What is valid beside which kind of file; limits are those of docs/worlds.md."""

import math
from pathlib import Path
from typing import Any

import pytest
from harness.world.terrain_file import TerrainFile, is_terrain_file

from harness.base.errors import UsageError

MAP, WORLD, MESH = (Path(f"a{suffix}") for suffix in (".TIF", ".world", ".stl"))
OF_HEIGHTMAPS = [("--terrain-size", {"size": (10.0, 50_000.0)}), ("--terrain-height", {"relief": 0.0})]
OF_OTHERS = [
    ("--resource-path", {"folders": (Path(),)}),
    ("--terrain-cell", {"cell": 0.02}),
    ("--mesh-unit", {"mesh_unit": "mm"}),
    ("--mesh-up", {"mesh_up": "y"}),
    ("--rock-height", {"rock_height": 0.0}),
    ("--rock", {"rocks": ("a",)}),
    ("--hazard", {"hazards": ("a",)}),
]


@pytest.mark.parametrize(("flag", "values"), OF_HEIGHTMAPS + OF_OTHERS)
def test_an_option_is_for_one_kind_of_file_and_told_beside_another(
    flag: str, values: dict[str, Any]
) -> None:
    theirs = [MAP] if (flag, values) in OF_HEIGHTMAPS else [WORLD, MESH]
    for path in (MAP, WORLD, MESH):
        file = TerrainFile(path=path, **values)
        if path in theirs:
            file.check()
        else:
            kinds = "heightmaps" if theirs == [MAP] else "SDF worlds and meshes"
            with pytest.raises(UsageError, match=f"{flag} is for {kinds}; leave it out with {path}"):
                file.check()


@pytest.mark.parametrize(
    ("path", "name", "good", "bad"),
    [
        (
            MAP,
            "size",
            [(10.0, 20.0), (50_000.0, 10.0)],
            [(9.9, 20.0), (20.0, 50_001.0), (20.0, math.nan)],
        ),
        (MAP, "relief", [0.0, 10_000.0], [-0.1, 10_001.0]),
        (MESH, "cell", [0.02, 10.0], [0.019, 10.1]),
        (MESH, "rock_height", [0.0, 10_000.0], [-0.1, 10_001.0]),
        (MESH, "mesh_unit", ["m", "mm"], ["furlong"]),
        (MESH, "mesh_up", ["z", "y"], ["w"]),
    ],
)
def test_values_are_valid_up_to_their_limits(
    path: Path, name: str, good: list[object], bad: list[object]
) -> None:
    for value in good:
        TerrainFile(path=path, **{name: value}).check()  # type: ignore[arg-type]
    for value in bad:
        with pytest.raises(UsageError, match=r"is not valid; give|does not exist; available"):
            TerrainFile(path=path, **{name: value}).check()  # type: ignore[arg-type]


def test_whatever_is_neither_a_world_nor_a_mesh_is_taken_for_a_heightmap() -> None:
    names = ("a.tif", "a.dem", "a", "a.SDF", "a.world", "a.obj", "a.STL")
    found = [TerrainFile(path=Path(name)).is_heightmap for name in names]
    assert found == [True] * 3 + [False] * 4


def test_a_file_is_known_by_its_suffix_its_folder_or_that_it_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hill").touch()
    (tmp_path / "flat").touch()  # a terrain's name is the terrain's all the same
    names = ("a.PNG", "a.sdf", "a.OBJ", "b/a", "hill", "flat", "hole")
    assert [is_terrain_file(name) for name in names] == [True] * 5 + [False] * 2
