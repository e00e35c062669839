"""What is mutated, and with which tests: the only place here that knows the project's folders."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("harness", "rover_metrics/rover_metrics")  # whose lines tell which tests use a constant
KERNELS = "harness/sensors/rays/*_kernel.py"
RUNS = "tests/golden"  # whole runs, which every room of the simulator is part of


@dataclass(frozen=True)
class Room:
    """Modules whose scores are counted together, and the tests that are to notice their mutants.

    Attributes:
        name: As the table of scores calls it.
        tests: Files and folders, from the root.
        plain: Whether numba must leave the modules uncompiled, so that they can be mutated.
    """

    name: str
    tests: tuple[str, ...]
    plain: bool = False


def room_of(file: str, root: Path = ROOT) -> Room:
    """Returns the room of a module: the folder below its package, whose tests mirror it.

    Args:
        file: The module, from the root.
        root: The folder of the tree.
    """
    if Path(file).match(KERNELS):
        return Room("lidar kernels", ("tests/harness/sensors",), plain=True)
    package = next((source for source in SOURCES if file.startswith(f"{source}/")), None)
    if package is None:
        return Room("elsewhere", existing(("tests/harness", "tests/rover_metrics"), root))
    folder, *rest = Path(file).relative_to(package).parts
    top = Path(package).name
    if top == "rover_metrics":
        return Room(f"{top}/{folder}" if rest else top, existing((f"tests/{top}",), root))
    own = f"tests/{top}/{folder}" if rest else f"tests/{top}"
    return Room(own.removeprefix("tests/"), existing((own, RUNS), root))


def existing(tests: tuple[str, ...], root: Path) -> tuple[str, ...]:
    """Returns those of some tests that there are."""
    return tuple(name for name in tests if (root / name).exists())


def modules(root: Path = ROOT) -> list[str]:
    """Returns every module that can be mutated, from the root."""
    found = (path for source in SOURCES for path in (root / source).rglob("*.py"))
    return sorted(str(path.relative_to(root)) for path in found)


def changed_since(base: str | None, root: Path = ROOT) -> set[str]:
    """Returns files that differ from a revision; from where the branch left `main` if none is named.

    Raises:
        ValueError: There is no such revision.
    """

    def git(*words: str) -> str:
        done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)  # noqa: S607
        if done.returncode:
            raise ValueError(done.stderr.strip())
        return done.stdout

    revision = base or git("merge-base", "HEAD", "main").strip()
    files = git("diff", "--name-only", revision) + git("ls-files", "--others", "--exclude-standard")
    return set(files.split())
