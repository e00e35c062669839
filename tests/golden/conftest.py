"""The option with which `make golden` keeps what the runs give now."""

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--accept", action="store_true", help="keep what the golden runs give now")
