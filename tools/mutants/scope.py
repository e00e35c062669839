"""What is mutated, and with which tests: the only place here that knows the project's folders."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Package:
    """Modules whose scores are told together.

    Attributes:
        name: As the table of scores calls it.
        modules: Patterns below the root.
        tests: Where its tests may be; all that can run in one process if empty.
        plain: Whether numba must leave the modules uncompiled, so that they can be mutated.
    """

    name: str
    modules: tuple[str, ...]
    tests: tuple[str, ...] = ()
    plain: bool = False


_METRICS, _HARNESS = "rover_metrics/rover_metrics", "harness"


def _modules(folder: str, names: str) -> tuple[str, ...]:
    return tuple(f"{folder}/{name}.py" for name in names.split())


PACKAGES = (
    Package("metrics", _modules(_METRICS, "core/* session topics")),
    Package("log", _modules(_METRICS, "log/*")),
    Package("timing and health", _modules(_METRICS, "timing/* health/* ros/row_timer")),
    Package(
        "extended columns",
        _modules(_METRICS, "extended/*"),
        tests=(
            *("tests/rover_metrics/core", "tests/rover_metrics/extended"),
            *_modules(
                "tests/rover_metrics",
                "test_dictionary test_extended_metrics test_metrics_properties test_session",
            ),
        ),
    ),
    Package(
        "statistics",
        _modules(
            f"{_METRICS}/analysis", "* logs/* statistics/* social/log social/metrics social/comparison"
        ),
    ),
    Package(
        "sensors",
        _modules(f"{_HARNESS}/sensors", "* rays/arrays"),
        tests=("tests/harness/sensors",),
    ),
    Package("faults", _modules(_HARNESS, "faults/*")),
    Package(
        "lidar kernels",
        _modules(f"{_HARNESS}/sensors/rays", "*_kernel"),
        tests=("tests/harness/sensors",),
        plain=True,
    ),
    Package("messages", _modules(_HARNESS, "ros/messages samples")),
    Package("truth", _modules(_HARNESS, "truth/* physics/contacts episode/truth_account")),
    Package(
        "episode",
        _modules(
            _HARNESS,
            "config sim_time physics/diff_drive physics/simulation episode/episode episode/loop"
            " episode/metrics_feed episode/result",
        ),
    ),
    Package(
        "verdicts",
        _modules(
            f"{_HARNESS}/scenario",
            "arrivals baseline bound case events judge quantities reading series topic verdict",
        ),
    ),
    Package(
        "learning environments",
        _modules(_HARNESS, "gym/*"),
        tests=("tests/harness/gym",),
    ),
    Package(
        "world",
        _modules(f"{_HARNESS}/world", "* terrains/* heightmap/*"),
        tests=("tests/harness/world",),
    ),
    Package(
        "people",
        _modules(_HARNESS, "world/actors/* physics/crowd episode/social_recorder"),
        tests=(
            "tests/harness/world/actors",
            *_modules(
                "tests/harness", "physics/test_crowd episode/test_social_recorder sensors/test_people"
            ),
        ),
    ),
    Package("tuning scores", _modules(f"{_HARNESS}/tuning", "scoring/* episodes/contacts")),
)

TESTS = ("tests/harness", "tests/rover_metrics")
SOURCES = (_HARNESS, _METRICS)  # whose lines tell which tests use a constant


def modules_of(package: Package, root: Path = ROOT) -> list[str]:
    """The files of a package, from the root."""
    found = {path for pattern in package.modules for path in root.glob(pattern)}
    return sorted(str(path.relative_to(root)) for path in found)


def changed_since(base: str | None, root: Path = ROOT) -> set[str]:
    """Files that differ from a revision; from where the branch left `main` if none is named.

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
