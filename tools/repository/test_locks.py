"""What is installed is pinned with hashes, and what cannot be audited is not called clean."""

import importlib.util
import os
import re
import shutil
import subprocess
from pathlib import Path
from types import ModuleType

import pytest
import tomllib

ROOT = Path(__file__).parents[2]
LOCKS = (
    "requirements.txt",
    "tools/run.txt",
    "tools/build.txt",
    "tools/jazzy.txt",
    "tools/cluster.txt",
    "tools/clients.txt",
    "tools/audit.txt",
    "tools/docs.txt",
    "tools/release.txt",
)
PIN = re.compile(r"([a-z0-9-]+)(?:\[[^]]*\])?==\S+( ; [^\\]+)? \\")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def normal(requirement: str) -> str:
    """The name in a requirement, as locks write it."""
    name = re.match(r"[\w.-]+", requirement)
    assert name, requirement
    return re.sub(r"[-_.]+", "-", name[0]).lower()


def pins(lock: str) -> dict[str, list[str]]:
    """Hashes of each package of a lock; every line must be a pin, one of its hashes or a comment."""
    found: dict[str, list[str]] = {}
    name = ""
    for line in (ROOT / lock).read_text().splitlines():
        if pin := PIN.fullmatch(line):
            name = pin[1]
            found.setdefault(name, [])
        elif digest := re.fullmatch(r"    --hash=sha256:([0-9a-f]{64})(?: \\)?", line):
            found[name].append(digest[1])
        else:
            assert line.startswith("#"), f"{lock}: {line}"
    return found


@pytest.mark.parametrize("lock", LOCKS)
def test_every_pin_has_hashes(lock: str) -> None:
    found = pins(lock)
    assert found
    assert all(found.values())


def test_everything_that_setup_installs_is_in_the_lock() -> None:
    extras = PROJECT["project"]["optional-dependencies"]
    installed = [*PROJECT["project"]["dependencies"], *extras["ros"], *extras["dev"]]
    installed += [*extras["video"], *extras["tune"]]  # which the tests try, through [dev]
    assert {normal(requirement) for requirement in installed} <= pins("requirements.txt").keys()


def test_a_run_installs_a_part_of_that_at_the_same_versions() -> None:
    whole = set(re.findall(r"(?m)^\S+==.*", (ROOT / "requirements.txt").read_text()))
    part = set(re.findall(r"(?m)^\S+==.*", (ROOT / "tools/run.txt").read_text()))
    assert part < whole
    assert {normal(one) for one in PROJECT["project"]["dependencies"]} <= pins("tools/run.txt").keys()


def test_what_builds_the_project_is_pinned_where_setup_takes_it_from() -> None:
    wanted = PROJECT["build-system"]["requires"]
    assert set(wanted) <= set((ROOT / "tools/build.in").read_text().splitlines())
    assert {normal(requirement) for requirement in wanted} <= pins("tools/build.txt").keys()


# An interpreter that keeps what it installs, becomes the environment's, and fails where it should.
PYTHON = """#!/bin/sh
case "$*" in
*rclpy*) exit 1 ;;
"-m venv .venv") mkdir -p .venv/bin && cp "$0" .venv/bin/python ;;
"-m pip config list") echo "global.index-url='https://mirror/simple'" ;;
*" install "*) echo "$UV_DEFAULT_INDEX $*" >>calls && echo "$*" | grep -qvE "$BROKEN" ;;
esac
"""


def set_up(folder: Path, *arguments: str, broken: str = "nothing") -> tuple[int, str, list[str]]:
    """Runs set-up where installations that match `broken` fail: exit code, output, installations."""
    (folder / "tools").mkdir()
    for name in ("tools/setup.sh", *LOCKS):
        shutil.copy(ROOT / name, folder / name)
    (folder / "python").write_text(PYTHON)
    (folder / "python").chmod(0o755)
    surroundings = os.environ | {"PYTHON": str(folder / "python"), "BROKEN": broken}
    command = [str(folder / "tools/setup.sh"), *arguments]
    run = subprocess.run(command, env=surroundings, capture_output=True, text=True, check=False)
    return run.returncode, run.stdout + run.stderr, (folder / "calls").read_text().splitlines()


@pytest.mark.parametrize(
    ("broken", "installers"),
    [
        ("nothing", "pip uv uv uv"),
        ("uv.txt", "pip pip pip pip"),  # no wheel of uv
        ("uv pip", "pip uv pip pip pip"),  # uv has no way to the index
    ],
)
@pytest.mark.parametrize(("verb", "lock"), [("run", "tools/run.txt"), ("", "requirements.txt")])
def test_set_up_fetches_nothing_without_a_hash_whoever_installs(
    broken: str, installers: str, verb: str, lock: str, tmp_path: Path
) -> None:
    code, told, calls = set_up(tmp_path, *([verb] if verb else []), broken=broken)
    assert code == 0, told
    assert [call.split()[2] for call in calls] == installers.split()
    assert ("which takes longer" in told) == (broken != "nothing")
    *fetching, own = calls
    assert all("--require-hashes --requirement" in call for call in fetching)
    assert own.endswith("--no-deps --editable .")
    assert all("--no-build-isolation" in call and call.startswith("https://mirror/") for call in calls)
    assert "tools/build.txt" in fetching[-2]  # what builds is there before anything that has to be built
    installed = (tmp_path / ".venv/requirements.txt").read_text()
    assert re.findall(r"\S+==\S+|sha256:\w+", installed) == re.findall(
        r"\S+==\S+|sha256:\w+", (ROOT / lock).read_text()
    )
    assert (tmp_path / ".venv/.ready").exists() == (not verb)
    assert (tmp_path / ".venv/.runs").exists()


def test_set_up_ends_where_a_hash_does_not_match(tmp_path: Path) -> None:
    code, told, _ = set_up(tmp_path, broken=".venv/requirements")
    assert code == 2
    assert "setup: pip could not install what requirements.txt pins" in told
    assert not (tmp_path / ".venv/.ready").exists()


def test_every_environment_is_filled_by_a_pip_that_keeps_to_its_lock() -> None:
    # pip 23 takes the newest coverage for coverage[toml], whatever is pinned.
    assert "pip" in pins("tools/build.txt")
    assert "for lock in build" in (ROOT / "tools/pinned.sh").read_text()


@pytest.fixture
def audit() -> ModuleType:
    spec = importlib.util.spec_from_file_location("audit", ROOT / "tools/audit.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_audit_without_an_index_says_that_nothing_was_checked(
    audit: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mirror = tmp_path / "no_advisories.json"
    mirror.write_text("{}")
    services = {
        "osv": ("file:///no/such/host", "affected"),
        "pypi": (mirror.as_uri(), "vulnerabilities"),
    }
    assert audit.main(services) == 0
    told = capsys.readouterr().out
    assert told.startswith("audit: NOTHING WAS CHECKED")
    assert "No such file" in told
    assert "without advisories" in told


def test_audit_asks_the_first_service_that_knows_advisories_and_fails_as_it_does(
    audit: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    index = tmp_path / "advisories.json"
    index.write_text('{"affected": []}')
    monkeypatch.setattr(audit, "audit", {"osv": 1}.__getitem__)
    services = {"pypi": ("file:///no/such/host", "vulnerabilities"), "osv": (index.as_uri(), "affected")}
    assert audit.main(services) == 1


def test_audit_reads_every_lock(audit: ModuleType) -> None:
    assert audit.LOCKS == LOCKS
