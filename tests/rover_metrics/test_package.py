"""The folder rover_metrics/ as an ament_python package."""

import runpy
import xml.etree.ElementTree as ET  # reads our own file
from pathlib import Path

import pytest

import harness
from rover_metrics.topics import SENSORS, TRUTH
from tests.support import dependencies

PACKAGE = Path(__file__).parents[2] / "rover_metrics"
MANIFEST = (PACKAGE / "package.xml").read_text()


def test_both_packages_carry_one_version(monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, object] = {}
    monkeypatch.setattr("setuptools.setup", lambda **options: given.update(options))
    monkeypatch.chdir(PACKAGE)  # as colcon
    runpy.run_path("setup.py")
    manifest = ET.parse("package.xml").getroot()  # noqa: S314
    assert manifest.findtext("version") == given["version"] == harness.__version__
    assert given["package_data"] == {"rover_metrics": ["py.typed"]}


def test_what_is_imported_is_declared_and_what_is_declared_is_imported() -> None:
    used = dependencies.imported() | {s.message_type.partition("/")[0] for s in (*SENSORS, *TRUTH)}
    assert used == dependencies.depended_on() | dependencies.told_to_install()


def test_pip_gets_all_that_is_not_a_package_of_ros() -> None:
    libraries = {word for word in dependencies.depended_on() if f"python3-{word}" in MANIFEST}
    assert dependencies.required() == libraries | dependencies.told_to_install()
