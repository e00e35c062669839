"""No pickle, no eval, no shell, no YAML that makes objects: nothing in the code could, so no input can.

What the painter of a run, a vector's processes and a sweep's workers send each other is pickled by
multiprocessing, over pipes that they inherit: nobody else can write into them. ruamel's own default
loader makes no objects.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("harness", "rover_metrics", "benchmarks", "tools", "examples")
UNPICKLING = ("pickle", "cPickle", "_pickle", "dill", "cloudpickle", "marshal", "shelve")
CALLS = ("eval", "exec", "compile", "__import__")
KINDS = (ast.Import, ast.ImportFrom, ast.Call)
OPTIONS = ("shell", "allow_pickle", "typ")
METHODS = {  # of these modules, whatever they are called there
    "os": ("system", "popen"),
    "yaml": ("load", "load_all", "unsafe_load", "full_load"),
    "joblib": ("load",),
    "pandas": ("read_pickle",),
    "subprocess": ("getoutput", "getstatusoutput"),
}


# Ray and Dask pickle whatever they carry; this unpickles on a worker what tuning itself has sent there.
EXCEPTIONS = {
    "harness/base/workers/clusters.py": ["pickle"],
    "tools/repository/test_ci.py": ["exec"],  # a script of the repository's own workflow
    "tools/mutants/mutations.py": ["compile"],  # mutants of the project's own sources, as below
    "tools/mutants/swap.py": ["compile", "compile"],
    # The notebooks of the repository, for the site.
    "tools/site/notebooks.py": ["exec", "eval", "exec", "compile", "compile", "compile"],
}


def harms(source: str) -> list[str]:
    """What of the forbidden a source does."""
    nodes = [node for node in ast.walk(ast.parse(source)) if isinstance(node, KINDS)]
    names = {
        alias.asname or alias.name: alias.name
        for node in nodes
        if isinstance(node, ast.Import)
        for alias in node.names
    }
    return [harm for node in nodes for harm in _of(node, names)]


def _of(node: ast.AST, names: dict[str, str]) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names if _unpickles(alias.name))
    elif isinstance(node, ast.ImportFrom):
        module = node.module or ""
        banned = METHODS.get(module, ())
        if _unpickles(module) or any(alias.name in banned for alias in node.names):
            yield module
    elif isinstance(node, ast.Call):
        yield from _calls(node, names)


def _unpickles(module: str) -> bool:
    return module.partition(".")[0] in UNPICKLING


def _calls(call: ast.Call, names: dict[str, str]) -> Iterator[str]:
    named = [keyword for keyword in call.keywords if keyword.arg in OPTIONS]
    given = {keyword.arg: ast.unparse(keyword.value) for keyword in named}
    if given.get("shell", "False") != "False":
        yield "shell"
    if given.get("allow_pickle", "False") != "False":
        yield "allow_pickle"
    if isinstance(call.func, ast.Name):
        if call.func.id in CALLS:
            yield call.func.id
        if call.func.id == "YAML" and given.get("typ", "'safe'") not in ("'safe'", "'rt'"):
            yield "YAML that makes objects"
    elif isinstance(call.func, ast.Attribute) and isinstance(call.func.value, ast.Name):
        module = names.get(call.func.value.id, call.func.value.id)
        if call.func.attr in METHODS.get(module, ()):
            yield f"{module}.{call.func.attr}"
        if (module, call.func.attr) == ("numpy", "load") and "allow_pickle" not in given:
            yield "numpy.load that does not say allow_pickle=False"


def test_no_source_unpickles_evaluates_or_starts_a_shell() -> None:
    found = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py")]
    assert len(found) > 200
    harmful = {str(p.relative_to(ROOT)): harm for p in found if (harm := harms(p.read_text()))}
    assert harmful == EXCEPTIONS


@pytest.mark.parametrize(
    "source",
    [
        "from pickle import loads",
        "import cloudpickle as c",
        "eval('1')",
        "exec(text)",
        "import os\nos.system('ls')",
        "import subprocess as s\ns.run('ls', shell=True)",
        "import yaml\nyaml.load(f)",
        "from yaml import unsafe_load",
        "YAML(typ=asked)",
        "import numpy as np\nnp.load(f)",
        "import pandas as pd\npd.read_pickle(f)",
    ],
)
def test_each_of_these_would_be_found_and_harmless_neighbours_are_not(source: str) -> None:
    assert harms(source)
    assert not harms("import json, re\njson.load(f)\nre.compile(x)\nmodel.eval()\nYAML(typ='safe')")


def test_gravity_is_the_worlds_and_no_number_in_a_function() -> None:
    """It is a rover's, a file's or a parameter's; names of modules may stand for what it is without."""
    for path in (p for folder in FOLDERS[:2] for p in (ROOT / folder).rglob("*.py")):
        if not re.search(r"\b9\.[78]", source := path.read_text()):
            continue
        functions = (n for n in ast.walk(ast.parse(source)) if isinstance(n, ast.FunctionDef))
        numbers = (n.value for of in functions for n in ast.walk(of) if isinstance(n, ast.Constant))
        assert not [n for n in numbers if isinstance(n, float) and 9.7 < n < 9.9], path
