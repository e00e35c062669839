"""Where the files are that a world names, and what is not looked at."""

from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.world.sdf.resources import VARIABLES, Missing, Resources, model_file


@pytest.fixture(autouse=True)
def no_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    for name in ("pkg/worlds/a.world", "pkg/meshes/m.dae", "else/other/b.obj", "secret.obj"):
        path = tmp_path / "top" / name if name != "secret.obj" else tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return tmp_path / "top"


@pytest.mark.parametrize(
    ("uri", "found"),
    [
        ("model://pkg/meshes/m.dae", "pkg/meshes/m.dae"),
        ("package://pkg/meshes/m.dae", "pkg/meshes/m.dae"),
        ("model:////pkg/meshes/m.dae", "pkg/meshes/m.dae"),
        ("FILE://../meshes/m.dae", "pkg/meshes/m.dae"),
        ("meshes/m.dae", "pkg/meshes/m.dae"),
        ("model://pkg/meshes/m%2Edae", "pkg/meshes/m.dae"),
    ],
)
def test_files_are_found_beside_a_world_and_two_folders_up(tree: Path, uri: str, found: str) -> None:
    assert Resources().find(uri, tree / "pkg/worlds/a.world") == tree / found


@pytest.mark.parametrize(
    ("uri", "told"),
    [
        ("https://fuel.gazebosim.org/1.0/x", "nothing is fetched; download it"),
        ("fuel://x", "nothing is fetched"),
        ("file:///home/somebody/m.dae", "no such file on this machine"),
        ("model://other/b.obj", "not found; name the folder that has other/ by --resource-path"),
        ("model://pkg/../../secret.obj", "leads out of the folders"),
        ("../../../secret.obj", "leads out of the folders"),
        ("", "names nothing"),
    ],
)
def test_what_cannot_be_had_is_named_with_the_reason(tree: Path, uri: str, told: str) -> None:
    with pytest.raises(Missing, match=told):
        Resources().find(uri, tree / "pkg/worlds/a.world")
    with pytest.raises(Missing, match="not found; name the folder"):  # / is none that is looked in
        Resources().find(f"model:/{tree}/else/other/b.obj", Path("/nowhere/a.world"))


def test_folders_are_looked_in_by_the_option_then_by_the_environment_then_beside_the_world(
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
        found = resources.find("model://other/b.obj", world)
        assert found == folder / "other/b.obj"
        found.unlink()
    with pytest.raises(UsageError, match=r"--resource-path .*nowhere is not a folder"):
        Resources((tree / "nowhere",))


def test_a_folder_means_the_newest_file_that_its_config_names(tmp_path: Path) -> None:
    folder = tmp_path / "thing"
    folder.mkdir()
    with pytest.raises(Missing, match=r"neither model\.config nor model\.sdf"):
        model_file(folder)
    for name in ("thing/model", "thing/m4", "thing/m6", "thing/m10", "secret"):
        (tmp_path / f"{name}.sdf").touch()
    assert model_file(folder) == folder / "model.sdf"
    config = folder / "model.config"
    for more, file in (
        ("<sdf/><sdf version='1.99'/><sdf>none.sdf</sdf>", "m6.sdf"),
        ("<sdf version='1.10'> m10.sdf </sdf>", "m10.sdf"),
    ):
        lines = more + "".join(f"<sdf version='1.{v}'>m{v}.sdf</sdf>" for v in ("4", "6"))
        config.write_text(f"<model>{lines}</model>")
        assert model_file(folder) == folder / file
    for text, told in (
        ("<sdf>../secret.sdf</sdf>", r"there is no \.\./secret\.sdf beside it"),
        ("<sdf>none.sdf</sdf>", r"there is no none\.sdf beside it"),
        ("", "names no <sdf>"),
    ):
        config.write_text(f"<model>{text}</model>")
        with pytest.raises(Missing, match=told):
            model_file(folder)
