"""Tests that are shared by processes tell what they tell alone, and none is lost."""

import os
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.processes import PORTIONS, portions

ROOT = Path(__file__).parents[1]
CONFTEST = """
import os, pathlib, pytest

@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    yield os.getpid()
    (pathlib.Path("ended") / tmp_path_factory.getbasetemp().name).touch(exist_ok=False)
"""
VARIED = """
import os, pytest

@pytest.mark.parametrize("number", range(9))
def test_passes(number, whole, tmp_path):
    assert whole == os.getpid()
    print("passing on")

def test_fails(whole):
    print("told by the test"); os.system("echo told by its child")
    assert whole == 1

@pytest.mark.skip(reason="not now")
def test_is_skipped(): ...

@pytest.mark.xfail(strict=True)
def test_is_expected_to_fail(): raise ValueError

def test_has_no_such_fixture(nobody): ...

@pytest.fixture(scope="module")
def broken():
    yield
    raise OSError("it does not end")

def test_leaves_what_does_not_end(broken): ...
"""
ENDING = """
import os, pytest, signal

@pytest.fixture(scope="session", autouse=True)
def broken():
    yield
    assert os.environ["PYTEST_PROCESS"] != "2", "the third does not end"

def test_goes(): os._exit(7)
def test_comes_after_it(): ...
def test_is_killed(): os.kill(os.getpid(), signal.SIGKILL)
def test_comes_last(): ...
"""
WAITING = """
import os, signal, time
def test_stops_all():
    os.killpg(0, signal.SIGINT)
    time.sleep(60)
def test_waits(): time.sleep(60)
"""


Outcomes = Counter[tuple[str, str]]


def outcomes(folder: Path, *options: str, **files: str) -> tuple[int, Outcomes, str]:
    """Exit code, how often what is told of each test, and all that is told."""
    (folder / "ended").mkdir(parents=True)
    for name, text in ({"conftest": CONFTEST} | files).items():
        (folder / f"{name}.py").write_text(text)
    command = [sys.executable, "-m", "pytest", "-rA", "-c", os.devnull, "--rootdir", "."]
    command += [
        "-p",
        "tests.support.processes",
        "-p",
        "no:cacheprovider",
        "--basetemp",
        "temp",
        *options,
    ]
    done = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        start_new_session=True,
    )
    told = re.findall(r"^([A-Z]+) (\S+)", done.stdout.rpartition("short test summary")[2], re.MULTILINE)
    return done.returncode, Counter(told), done.stdout


def test_every_test_tells_what_it_tells_alone(tmp_path: Path) -> None:
    files = {"test_one": VARIED, "test_two": VARIED}
    code, alone, _ = outcomes(tmp_path / "alone", **files)
    shared = outcomes(tmp_path / "shared", "--processes", "3", **files)
    assert shared[:2] == (code, alone)
    assert code == 1
    assert sum(alone.values()) == 2 * (9 + 1 + 1 + 1 + 1 + 2)
    assert shared[2].count("told by the test\ntold by its child\n") == 2
    assert {path.name for path in (tmp_path / "shared/ended").iterdir()} == {
        f"process{number}" for number in range(3)
    }


def test_a_test_that_ends_its_process_has_failed_and_the_others_run(tmp_path: Path) -> None:
    code, told, whole = outcomes(tmp_path, "--processes", "2", test_one=ENDING)
    assert code == 1
    assert told == {
        ("FAILED", "test_one.py::test_goes"): 1,
        ("FAILED", "test_one.py::test_is_killed"): 1,
        ("PASSED", "test_one.py::test_comes_after_it"): 1,
        ("PASSED", "test_one.py::test_comes_last"): 1,
        ("ERROR", "test_one.py::test_comes_last"): 1,
    }
    for words in ("ended with 7", "ended with -9", "the third does not end"):
        assert words in whole


@pytest.mark.parametrize(
    ("text", "options", "code", "told"),
    [
        (WAITING, [], 2, "KeyboardInterrupt"),
        (ENDING, ["-x"], 1, "stopping after 1 failures"),
        ("import nothing_of_this_name", [], 2, "1 error during collection"),
    ],
)
def test_what_stops_the_tests_stops_all_processes(
    text: str, options: list[str], code: int, told: str, tmp_path: Path
) -> None:
    ended = outcomes(tmp_path, "--processes", "2", *options, test_one=text)
    assert ended[0] == code
    assert told in ended[2]
    assert ("PASSED", "test_one.py::test_comes_last") not in ended[1]


@given(st.lists(st.integers(1, 40), min_size=1), st.integers(2, 8))
def test_each_test_is_given_out_once_with_those_of_its_file_and_fewer_towards_the_end(
    sizes: list[int], processes: int
) -> None:
    files = [file for file, size in enumerate(sizes) for _ in range(size)]
    given_out = list(portions(files, processes))
    assert [index for portion in given_out for index in range(*portion)] == list(range(len(files)))
    for first, end in given_out:
        assert len(set(files[first:end])) == 1
        assert end - first <= max(1, (len(files) - first) // (PORTIONS * processes))
