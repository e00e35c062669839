"""Stand-ins that this process and its workers load by name."""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

HERE = Path(__file__).parent


@pytest.fixture
def stand_ins(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The module stand_ins, also in processes that this one starts."""
    monkeypatch.syspath_prepend(HERE)
    yield importlib.import_module("stand_ins")
    sys.modules.pop("stand_ins")
