"""The folder rover_metrics/ as an ament_python package."""

import re
import runpy
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET  # reads our own file
from pathlib import Path

import pytest

import harness
from rover_metrics.topics import SENSORS, TRUTH
from tests.support import dependencies

PACKAGE = Path(__file__).parents[2] / "rover_metrics"
MANIFEST = (PACKAGE / "package.xml").read_text()
COLCON = shutil.which("colcon", path=str(Path(sys.executable).parent)) or shutil.which("colcon")
needs_colcon = pytest.mark.skipif(COLCON is None, reason="needs colcon: pip install .[dev]")


def colcon(*args: str, cwd: Path) -> str:
    assert COLCON is not None
    command = [COLCON, "--log-base", str(cwd / "log"), *args, "--base-paths", str(PACKAGE)]
    run = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout


@needs_colcon
def test_colcon_takes_it_for_an_ament_python_package(tmp_path: Path) -> None:
    assert re.fullmatch(r"rover_metrics\t.*\t\(ros\.ament_python\)\n", colcon("list", cwd=tmp_path))


def test_both_packages_carry_one_version(monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, object] = {}
    monkeypatch.setattr("setuptools.setup", lambda **options: given.update(options))
    monkeypatch.chdir(PACKAGE)  # as colcon
    runpy.run_path("setup.py")
    manifest = ET.parse("package.xml").getroot()  # noqa: S314
    assert manifest.findtext("version") == given["version"] == harness.__version__
    assert given["package_data"] == {"rover_metrics": ["py.typed"]}


def test_the_package_knows_nothing_of_the_harness_or_mujoco() -> None:
    for module in (PACKAGE / "rover_metrics").rglob("*.py"):
        assert not re.search(r"^\s*(import|from) (harness|mujoco)\b", module.read_text(), re.MULTILINE)


def test_what_is_imported_is_declared_and_what_is_declared_is_imported() -> None:
    used = dependencies.imported() | {s.message_type.partition("/")[0] for s in (*SENSORS, *TRUTH)}
    assert used == dependencies.depended_on() | dependencies.told_to_install()


def test_pip_gets_all_that_is_not_a_package_of_ros() -> None:
    libraries = {word for word in dependencies.depended_on() if f"python3-{word}" in MANIFEST}
    assert dependencies.required() == libraries | dependencies.told_to_install()
