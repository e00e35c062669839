"""The files of the runs, and the option with which `make golden` keeps what the runs give now."""

from pathlib import Path

import pytest

from tests.golden.drive import make_files
from tests.support.once import made_once


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--accept", action="store_true", help="keep what the golden runs give now")


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The worlds, rovers and parameters that the runs name."""
    return made_once(
        tmp_path_factory, "golden_files", lambda: make_files(tmp_path_factory.mktemp("golden"))
    )
