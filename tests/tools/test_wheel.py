"""What a wheel carries beside the modules."""

from pathlib import Path
from zipfile import ZipFile

import pytest

wheel = pytest.importorskip("hatchling.builders.wheel", reason="needs hatchling, which builds it")

ROOT = Path(__file__).parents[2]


def test_a_wheel_carries_the_modules_the_models_and_the_parameter_files(tmp_path: Path) -> None:
    (built,) = wheel.WheelBuilder(str(ROOT)).build(directory=str(tmp_path), versions=["standard"])
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
