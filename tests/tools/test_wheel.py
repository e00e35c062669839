"""What a wheel carries beside the modules, built from no more than the Containerfile copies."""

from pathlib import Path
from shutil import copyfile, copytree, ignore_patterns
from zipfile import ZipFile

import pytest

wheel = pytest.importorskip("hatchling.builders.wheel", reason="needs hatchling, which builds it")

ROOT = Path(__file__).parents[2]


def copy(path: Path, goal: Path) -> None:
    if path.is_dir():
        copytree(path, goal, ignore=ignore_patterns("__pycache__"))
    else:
        goal.parent.mkdir(exist_ok=True)
        copyfile(path, goal)


def test_a_wheel_of_what_the_container_copies_has_modules_models_and_parameter_files(
    tmp_path: Path,
) -> None:
    source = tmp_path / "source"
    for step, *names in map(str.split, filter(None, (ROOT / "Containerfile").read_text().splitlines())):
        if step == "COPY" and not names[0].startswith("--"):
            for name in names[:-1]:
                assert names[-1] in ("./", name)
                copy(ROOT / name, source / name)
    (built,) = wheel.WheelBuilder(str(source)).build(directory=str(tmp_path), versions=["standard"])
    files = {name for name in ZipFile(built).namelist() if ".dist-info/" not in name}
    kinds = {
        "harness": "harness",
        "rover_metrics/rover_metrics": "rover_metrics",
        "models": "harness/models",
    }
    kinds["rover_metrics/config"] = "rover_metrics/config"
    there = {
        f"{goal}/{path.relative_to(ROOT / source)}"
        for source, goal in kinds.items()
        for path in (ROOT / source).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert files == there
    assert {f"rover_metrics/config/{name}.yaml" for name in ("leo", "metrics", "rover_zero4wd")} <= files
