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
        tests: Where its own tests are, which must notice a mutant; TESTS if empty.
        plain: Whether numba must leave the modules uncompiled, so that they can be mutated.
    """

    name: str
    modules: tuple[str, ...]
    tests: tuple[str, ...] = ()
    plain: bool = False


_METRICS, _HARNESS = "rover_metrics/rover_metrics", "harness"


def _modules(folder: str, names: str) -> tuple[str, ...]:
    return tuple(f"{folder}/{name}.py" for name in names.split())


def _tests(names: str) -> tuple[str, ...]:
    return tuple(f"tests/{name}" for name in names.split())


PACKAGES = (
    Package(
        "metrics",
        _modules(_METRICS, "core/* session topics"),
        _tests(
            "rover_metrics/core rover_metrics/test_dictionary.py"
            " rover_metrics/test_metrics_properties.py rover_metrics/test_session.py"
            " rover_metrics/test_topics.py"
        ),
    ),
    Package(
        "log",
        _modules(_METRICS, "log/*"),
        _tests("rover_metrics/log rover_metrics/test_analyzer_format.py"),
    ),
    Package(
        "timing and health",
        _modules(_METRICS, "timing/* health/* ros/row_timer"),
        _tests(
            "rover_metrics/timing rover_metrics/health rover_metrics/ros/test_row_timer.py"
            " rover_metrics/test_replay.py"
        ),
    ),
    Package(
        "extended columns",
        _modules(_METRICS, "extended/*"),
        _tests(
            "rover_metrics/core rover_metrics/extended rover_metrics/ros/test_parameters.py"
            " rover_metrics/test_dictionary.py rover_metrics/test_extended_metrics.py"
            " rover_metrics/test_metrics_properties.py rover_metrics/test_session.py"
        ),
    ),
    Package(
        "statistics",
        _modules(
            f"{_METRICS}/analysis", "* logs/* statistics/* social/log social/metrics social/comparison"
        ),
        _tests("rover_metrics/analysis"),
    ),
    Package(
        "sensors",
        _modules(f"{_HARNESS}/sensors", "* rays/arrays"),
        _tests("harness/sensors"),
    ),
    Package("faults", _modules(_HARNESS, "faults/*"), _tests("harness/faults")),
    Package(
        "lidar kernels",
        _modules(f"{_HARNESS}/sensors/rays", "*_kernel"),
        _tests("harness/sensors"),
        plain=True,
    ),
    Package(
        "messages",
        _modules(_HARNESS, "ros/messages samples"),
        _tests("harness/ros/test_messages.py harness/test_samples.py rover_metrics/test_topics.py"),
    ),
    Package(
        "truth",
        _modules(_HARNESS, "truth/* physics/contacts episode/truth_account"),
        _tests(
            "harness/truth harness/physics/test_contacts.py harness/physics/test_crowd.py"
            " harness/physics/test_physics.py harness/episode/test_truth_account.py"
        ),
    ),
    Package(
        "episode",
        _modules(
            _HARNESS,
            "config sim_time physics/base_controller physics/simulation episode/episode episode/loop"
            " episode/metrics_feed episode/result",
        ),
        _tests("harness/episode harness/physics harness/test_config.py harness/test_sim_time.py"),
    ),
    Package(
        "verdicts",
        _modules(
            f"{_HARNESS}/scenario",
            "arrivals baseline bound case events judge quantities reading series topic verdict",
        ),
        _tests("harness/scenario"),
    ),
    Package("learning environments", _modules(_HARNESS, "gym/*"), _tests("harness/gym")),
    Package("world", _modules(f"{_HARNESS}/world", "* terrains/* heightmap/*"), _tests("harness/world")),
    Package(
        "worlds from files",
        _modules(f"{_HARNESS}/world", "sdf/* solids/*"),
        _tests("harness/world/sdf harness/world/solids"),
    ),
    Package(
        "people",
        _modules(_HARNESS, "world/actors/* physics/crowd episode/social_recorder"),
        _tests(
            "harness/world/actors harness/physics/test_crowd.py harness/sensors/test_people.py"
            " harness/episode/test_social_recorder.py"
        ),
    ),
    Package(
        "tuning scores",
        _modules(f"{_HARNESS}/tuning", "scoring/* episodes/contacts"),
        _tests("harness/tune/scoring harness/tune/episodes"),
    ),
)

TESTS = ("tests/harness", "tests/rover_metrics")  # all that can run in one process
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
