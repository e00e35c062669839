"""What is installed is pinned with hashes, and what cannot be audited is not called clean."""

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest
import tomllib

ROOT = Path(__file__).parents[2]
LOCKS = (
    "requirements.txt",
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


def test_what_builds_the_project_is_pinned_where_setup_takes_it_from() -> None:
    wanted = PROJECT["build-system"]["requires"]
    assert set(wanted) <= set((ROOT / "tools/build.in").read_text().splitlines())
    assert {normal(requirement) for requirement in wanted} <= pins("tools/build.txt").keys()


def test_every_environment_is_filled_by_a_pip_that_keeps_to_its_lock() -> None:
    # pip 23 takes the newest coverage for coverage[toml], whatever is pinned.
    assert "pip" in pins("tools/build.txt")
    for script in ("setup.sh", "pinned.sh"):  # what installs before the lock itself
        installs = re.findall(r"locked=\S+|for lock in \S+", (ROOT / "tools" / script).read_text())
        assert installs[0] in ("locked=tools/build.txt", "for lock in build")


def test_set_up_fetches_nothing_without_a_hash() -> None:
    lines = (ROOT / "tools/setup.sh").read_text().splitlines()
    assert sum("--requirement" in line and "--require-hashes" in line for line in lines) == 2
    assert sum("--editable" in line and "--no-deps" in line for line in lines) == 1
    assert all("--no-build-isolation" in line for line in lines if "-m pip" in line)
    assert len([line for line in lines if re.search("--requirement|--editable", line)]) == 3


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
