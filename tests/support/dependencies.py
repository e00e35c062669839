"""What the package rover_metrics imports, what it declares, and an interpreter that has nothing else."""

import ast
import re
import sys
import xml.etree.ElementTree as ET  # reads our own file
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, distributions, requires
from pathlib import Path

from packaging.requirements import Requirement

PACKAGE = Path(__file__).parents[2] / "rover_metrics"

# A sitecustomize.py: without these top-level modules.
HIDES = """import sys

class Hidden:
    def find_spec(name, path=None, target=None):
        if name.partition(".")[0] in {hidden!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}: it is not declared", name=name)

sys.meta_path.insert(0, Hidden)
"""


def imported() -> set[str]:
    """The top-level modules that the package imports anywhere, but for its own and Python's."""
    found = set()
    for path in [*PACKAGE.glob("rover_metrics/**/*.py"), *PACKAGE.glob("launch/*.py")]:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                found.add(str(node.module).partition(".")[0])
    return found - sys.stdlib_module_names - {"rover_metrics"}


def required() -> set[str]:
    """What setup.py asks of pip, as the modules are called."""
    text = (PACKAGE / "setup.py").read_text()
    words = [k for k in ast.walk(ast.parse(text)) if isinstance(k, ast.keyword)]
    (names,) = (ast.literal_eval(word.value) for word in words if word.arg == "install_requires")
    return {Requirement(name).name.partition(".")[0] for name in names}


def depended_on() -> set[str]:
    """What package.xml asks of rosdep, as the modules are called."""
    names = ET.parse(PACKAGE / "package.xml").getroot().findall("exec_depend")  # noqa: S314
    return {str(name.text).removeprefix("python3-") for name in names}


def told_to_install() -> set[str]:
    """What package.xml tells its reader to install with pip, as the modules are called."""
    text = (PACKAGE / "package.xml").read_text()
    (words,) = re.findall(r"pip install ([\w. ]+) \(they bring ([\w. ]+)\)", text)
    asked, brought = ({word.partition(".")[0] for word in part.split()} for part in words)
    assert brought <= with_their_own(asked)
    return asked | brought


def with_their_own(modules: Iterable[str]) -> set[str]:
    """Modules, and all that their distributions require."""
    providers = _providers()
    left, seen = {d for module in modules for d in providers.get(module, ())}, set()
    while left:
        distribution = left.pop()
        seen.add(distribution)
        try:
            needs = map(Requirement, requires(distribution) or ())
        except PackageNotFoundError:
            continue
        wanted = {
            need.name for need in needs if need.marker is None or need.marker.evaluate({"extra": ""})
        }
        left |= wanted - seen
    plain = {_plain(distribution) for distribution in seen}
    return {m for m, there in providers.items() if plain & set(map(_plain, there))} | set(modules)


def hide_all_but(modules: Iterable[str], folder: Path) -> None:
    """Makes a Python with this folder in its PYTHONPATH know only these libraries and what they need."""
    hide({*_providers(), "harness"} - with_their_own(modules), folder)


def hide(modules: Iterable[str], folder: Path) -> None:
    """Makes a Python with this folder in its PYTHONPATH not know these top-level modules."""
    (folder / "sitecustomize.py").write_text(HIDES.format(hidden=set(modules)))


@cache
def _providers() -> Mapping[str, set[str]]:
    """As packages_distributions, which in Python 3.10 knows only those with a top_level.txt."""
    providers: dict[str, set[str]] = {}
    for distribution in distributions():
        name = distribution.metadata["Name"]  # is parsed anew each time
        files = (file for file in distribution.files or () if file.suffix in (".py", ".so"))
        for module in {file.parts[0].partition(".")[0] for file in files}:
            if module.isidentifier():
                providers.setdefault(module, set()).add(name)
    return providers


def _plain(distribution: str) -> str:
    return re.sub(r"[-_.]+", "-", distribution).lower()
