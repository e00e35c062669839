"""Which terrains are files, and which options are for which kind of file."""

import re
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.episode.assembly import check
from harness.spec.run import Run
from harness.spec.world import FILE_FIELDS, HEIGHTMAPS, SOLIDS
from harness.world.files import is_heightmap, is_terrain_file

GIVEN: dict[str, Any] = {"terrain_size": (10.0, 50_000.0), "terrain_height": 0.0, "terrain_cell": 0.02}
GIVEN |= {"terrain_roughness": "C"}
GIVEN |= {"resource_path": (".",), "mesh_unit": "mm", "mesh_up": "y", "rock_height": 0.0}
GIVEN |= {"rock": ("a",), "hazard": ("a",)}
KINDS = {"rocky": "", "a.TIF": HEIGHTMAPS, "a.dem/b": HEIGHTMAPS, "a.npy": HEIGHTMAPS}
KINDS |= dict.fromkeys(("a.world", "a.SDF", "a.stl", "a.OBJ", "a.dae"), SOLIDS)


@pytest.mark.parametrize("terrain", KINDS)
def test_an_option_is_refused_beside_another_kind_of_terrain(terrain: str) -> None:
    for name, kind in FILE_FIELDS.items():
        run, flag = Run.of(terrain=terrain, **{name: GIVEN[name]}), name.replace("_", "-")
        said = f"--{flag} applies to {kind} only; leave it out with {Path(terrain).name}"
        refused = KINDS[terrain] != kind
        with pytest.raises(UsageError, match=re.escape(said)) if refused else nullcontext():
            check(run)


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"mesh_unit": "furlong"}, "mesh unit 'furlong' does not exist; available: m, cm, mm, ft, in"),
        ({"mesh_up": "w"}, "mesh axis 'w' does not exist; available: z, y, x"),
        ({"difficulty": 0.4}, "a terrain from a file has no difficulty"),
    ],
)
def test_what_is_not_valid_is_refused_with_what_is(fields: dict[str, Any], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        check(Run.of(terrain="a.stl", **fields))


def test_a_file_is_known_by_its_suffix_its_folder_or_that_it_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hill").touch()
    (tmp_path / "flat").touch()  # a terrain's name is the terrain's all the same
    names = ("a.PNG", "a.sdf", "a.OBJ", "b/a", "hill", "flat", "hole")
    assert [is_terrain_file(name) for name in names] == [True] * 5 + [False] * 2
    assert [is_heightmap(f"a{end}") for end in ("", ".PNG", ".SDF", ".obj")] == [True] * 2 + [False] * 2
