"""Files are written where the user said, whatever names stand in the data; data makes no objects."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.base.documents import read_json, read_mapping
from harness.base.mesh_file import read_mesh
from harness.drivers.policy import read_policy
from harness.robots.strangers import read_xml
from harness.run import main as run
from harness.validate.single_wheel import read_trials
from harness.world.actors.people import read_trajectories
from harness.world.heightmap.raster import read_raster
from rover_metrics import analyze
from rover_metrics.analysis.logs.reading import read_log
from rover_metrics.bag.bag_reader import Bag
from rover_metrics.bag.mcap_stream import BagError
from rover_metrics.core.columns import COLUMNS
from rover_metrics.errors import KnownError, RoverMetricsError
from rover_metrics.extended.parameter_file import read_values

SECRET = "not for you"  # noqa: S105 - what must not be touched
HOSTILE_NAMES = ("..csv", "..%2f..%2fup.csv", "$(touch up).csv", "a;touch up.csv", "a\nb.csv")


def tree(folder: Path) -> set[Path]:
    return {path for path in folder.rglob("*") if not path.is_dir()}


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A file beside the chosen folder."""
    path = tmp_path / "outside.txt"
    path.write_text(SECRET)
    return path


def test_names_of_logs_do_not_decide_where_analyze_writes(
    tmp_path: Path, outside: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    logs, output = tmp_path / "logs", tmp_path / "output"
    logs.mkdir()
    for name in HOSTILE_NAMES:
        rows = [f"{i},0,0,{i},1,{i % 5},{i},{i % 4},{i % 7},0,0.5,Normal operation" for i in range(20)]
        (logs / name).write_text("\n".join([",".join(COLUMNS), *rows]) + "\n")
    before = tree(tmp_path)
    files = [str(logs / name) for name in HOSTILE_NAMES]
    assert analyze.main([*files, "-p", "correlation", "-o", str(output)]) == 0, capsys.readouterr().err
    written = tree(tmp_path) - before
    assert written
    assert all(path.parent == output for path in written)
    assert outside.read_text() == SECRET


@pytest.mark.parametrize("listed", ["../FILE", "FOLDER/FILE", "a/../../FILE", ".."])
def test_metadata_cannot_make_a_bag_read_files_elsewhere(tmp_path: Path, listed: str) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "broken.mcap").touch()
    (tmp_path / "elsewhere.mcap").write_text(SECRET)
    name = listed.replace("FOLDER", str(tmp_path)).replace("FILE", "elsewhere.mcap")
    paths = f"[{name!r}, broken.mcap]"
    (bag / "metadata.yaml").write_text(f"rosbag2_bagfile_information:\n  relative_file_paths: {paths}\n")
    with pytest.raises(BagError) as refused:
        Bag(bag)
    assert "neither MCAP" not in str(refused.value), "it was opened"
    assert "broken.mcap: the file is empty" in str(refused.value)


READERS: dict[str, Callable[[Path], object]] = {
    "a.sdf": read_trajectories,
    "a.stl": read_mesh,
    "a.npy": read_raster,
    "a.npz": read_policy,
    "a.urdf": read_xml,
    "a.yaml": read_values,
    "a.json": read_json,
    "a.mcap": Bag,
    "a.csv": read_trials,
    "b.csv": read_log,
}


@pytest.mark.parametrize("name", READERS)
def test_pipes_and_devices_are_not_waited_for(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / name)
    (tmp_path / f"null_{name}").symlink_to("/dev/zero")
    for path in (tmp_path / name, tmp_path / f"null_{name}"):
        with pytest.raises(Exception, match=r"is not a (regular )?file") as refused:
            READERS[name](path)
        assert isinstance(refused.value, KnownError)
        assert str(refused.value).isprintable()


def test_a_pipe_of_the_shell_is_read() -> None:
    reading, writing = os.pipe()
    os.write(writing, b"a: 1")
    os.close(writing)
    assert read_mapping(Path(f"/dev/fd/{reading}")) == {"a": 1}


OBJECT = "!!python/object/apply:pathlib.Path.touch [!!python/object/apply:pathlib.Path [{}]]\n"


@pytest.mark.parametrize("read", [read_values, lambda path: Bag(path.parent)])
def test_yaml_makes_no_objects(read: Callable[[Path], object], tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "empty.mcap").touch()
    (bag / "metadata.yaml").write_text(OBJECT.format(tmp_path / "touched"))
    with pytest.raises(RoverMetricsError):
        read(bag / "metadata.yaml")
    assert not (tmp_path / "touched").exists()


def test_what_a_run_writes_follows_no_link_and_leaves_nothing_else(
    tmp_path: Path, outside: Path
) -> None:
    chosen = tmp_path / "chosen"
    chosen.mkdir()
    page, summary = chosen / "page.html", chosen / "run.json"
    for path in (page, summary):
        path.symlink_to(outside)
    words = ["--direct", "--terrain", "flat", "--duration", "1", "--log-dir", str(chosen / "logs")]
    assert run([*words, "--report", str(page), "--summary", str(summary)]) == 0
    assert outside.read_text() == SECRET
    assert {path for path in tree(chosen) if path.parent == chosen} == {page, summary}
    assert not page.is_symlink()
    assert not summary.is_symlink()
    assert {path.suffix for path in tree(chosen / "logs")} == {".csv", ".json"}
