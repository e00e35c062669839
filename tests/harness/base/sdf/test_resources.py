"""Where the files are that a world names, and what is not looked at."""

import re
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.base.sdf.resources import VARIABLES, Missing, Resources, model_file


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    inside = ("worlds/a.world", "meshes/m.dae", "models/rock/r.obj")
    for name in (*(f"top/pkg/{file}" for file in inside), "top/else/other/b.obj", "secret.obj"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    return tmp_path / "top"


def test_files_are_found_beside_a_world_and_two_folders_up(tree: Path) -> None:
    for uri in (
        *("model://pkg/meshes/m.dae", "package://pkg/meshes/m.dae", "model:////pkg/meshes/m.dae"),
        *("FILE://../meshes/m.dae", "meshes/m.dae", "model://pkg/meshes/m%2Edae"),
    ):
        assert Resources().find(uri, tree / "pkg/worlds/a.world") == tree / "pkg/meshes/m.dae"
    rock = tree / "pkg/models/rock/r.obj"  # of a package as most are laid out
    assert Resources().find("model://rock/r.obj", tree / "pkg/worlds/a.world") == rock


@pytest.mark.parametrize(
    ("uri", "said"),
    [
        ("https://fuel.gazebosim.org/1.0/x", "nothing is fetched; download it"),
        ("file:///home/somebody/m.dae", "no such file on this machine"),
        ("model://other/b.obj", "not found; name the folder that has other/ by --resource-path"),
        ("model://pkg/../../secret.obj", "leads out of the folders"),
        ("../../../secret.obj", "leads out of the folders"),
        ("", "names nothing"),
    ],
)
def test_what_cannot_be_had_is_named_with_the_reason(tree: Path, uri: str, said: str) -> None:
    with pytest.raises(Missing, match=said):
        Resources().find(uri, tree / "pkg/worlds/a.world")
    with pytest.raises(Missing, match="not found; name the folder"):  # / is none that is looked in
        Resources().find(f"model:/{tree}/else/other/b.obj", Path("/nowhere/a.world"))


def test_folders_of_the_option_come_before_the_environment_and_the_world(
    tree: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    world = tree / "pkg/worlds/a.world"
    folders = [*(tree / name for name in ("option", *VARIABLES)), world.parent]
    for folder in folders:
        (folder / "other").mkdir(parents=True)
        (folder / "other/b.obj").touch()
    for name, folder in zip(VARIABLES, folders[1:], strict=False):
        monkeypatch.setenv(name, f":/nowhere:{folder}")
    resources = Resources(folders[:1])
    for folder in folders:
        path = resources.find("model://other/b.obj", world)
        assert path == folder / "other/b.obj"
        path.unlink()
    with pytest.raises(UsageError, match=r"--resource-path .*nowhere is not a folder"):
        Resources((tree / "nowhere",))


def test_a_folder_means_the_newest_file_that_its_config_names(tmp_path: Path) -> None:
    (folder := tmp_path / "thing").mkdir()
    with pytest.raises(Missing, match=r"neither model\.config nor model\.sdf"):
        model_file(folder)
    for name in ("thing/model", "thing/m4", "thing/m6", "thing/m10", "secret"):
        (tmp_path / f"{name}.sdf").touch()
    assert model_file(folder) == folder / "model.sdf"
    versions = "".join(f"<sdf version='1.{v}'>m{v}.sdf</sdf>" for v in ("4", "6"))
    for config, expected in (
        (f"<sdf/><sdf version='1.99'/><sdf>none.sdf</sdf>{versions}", "m6.sdf"),
        (f"<sdf version='1.10'> m10.sdf </sdf>{versions}", "m10.sdf"),
        *(("<sdf>../secret.sdf</sdf>", "there is no ../secret.sdf beside it"), ("", "names no <sdf>")),
    ):
        (folder / "model.config").write_text(f"<model>{config}</model>")
        if expected.startswith("m"):
            assert model_file(folder) == folder / expected
            continue
        with pytest.raises(Missing, match=re.escape(expected)):
            model_file(folder)
