"""Kernels as Python runs them: what numba compiles, line by line."""

import importlib
import importlib.util
from types import ModuleType

import numba
import pytest

from harness.sensors.rays import compiled


def as_plain_python(name: str, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A module of kernels loaded once more, by itself, with nothing compiled.

    Where numba compiles nothing anyway (NUMBA_DISABLE_JIT), it is the module itself.

    Args:
        name: Of the module, e.g. "harness.sensors.rays.heightfield_kernel".
        monkeypatch: Of the test.
    """
    if numba.config.DISABLE_JIT:
        return importlib.import_module(name)
    spec = importlib.util.find_spec(name)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with monkeypatch.context() as patch:
        patch.setattr(compiled, "kernel", lambda _signature: lambda function: function)
        patch.setattr(compiled, "inlined", lambda function: function)
        spec.loader.exec_module(module)
    return module
