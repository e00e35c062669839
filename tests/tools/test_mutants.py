"""Mutants of a tiny project, and which tests the mutants of this one are given to."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.once import made_once
from tools.mutants import __main__ as command
from tools.mutants import scores
from tools.mutants.journal import Outcome
from tools.mutants.mutant import Mutant
from tools.mutants.scope import ROOT, changed_since, modules, room_of

CODE = '''"""Tanks."""

from dataclasses import dataclass
from functools import cache

_HALF = 3.75  # l
FULL = _HALF + _HALF
KINDS = ("oil", "water")
PAIR = divmod(7, 2)


@dataclass(frozen=True)
class Tank:
    """A tank."""

    litres: float = 3.0

    @property
    def is_low(self) -> bool:
        """Whether it should be filled."""
        return self.litres < 1.0


@cache
def lack(tank: Tank) -> float:
    """What fits in."""
    return FULL - tank.litres


def countdown(n: int) -> int:
    while n > 0:
        n -= 1
    return n


def unseen(a: float) -> float:
    if a > 9.0:
        raise ValueError("too much: " + str(a + 1))
    return a * 2
'''
TESTS = """import sys

import pytest
from tank import FULL, KINDS, Tank, countdown, lack


@pytest.fixture(scope="module")
def emptied():
    return Tank(0.0), Tank(1.0), countdown(3)


def test_first_user_of_a_shared_fixture_asks_nothing(emptied):
    assert emptied


def test_other_user_does(emptied):
    assert emptied[0].is_low and not emptied[1].is_low and emptied[2] == 0


def test_lack():
    assert lack(Tank(2.5)) == 5.0


@pytest.mark.parametrize("kind", KINDS)
def test_kind(kind):
    assert kind in ("oil", "water")


def test_weak():
    assert Tank().litres > 0


def test_that_always_fails():
    assert not lack(Tank())


def test_that_fails_unless_its_lines_are_traced():
    assert lack(Tank()) and sys.gettrace()
"""
FATES = [
    ("lack", "return FULL + tank.litres", "test_lack"),  # wrapped by a decorator
    ("Tank.is_low", "return self.litres <= 1.0", "test_other_user_does"),  # a property
    ("", "_HALF = 4.6875 # l", "test_lack"),  # of which a constant is made that others have imported
    ("", 'KINDS = ("oilX", "water")', "test_kind[oilX]"),  # of which a test has its name
    ("", "PAIR = divmod(7)", "import"),
    ("Tank", "litres: float = 3.75", ""),  # a default that only the weak test looks at
    ("countdown", "n -= 2", "test_other_user_does"),  # by way of a fixture that another used first
    ("countdown", "n -= 0", "time-out or crash"),
    ("countdown", "while n > (-1):", "test_other_user_does"),
    ("unseen", "return a * 3", ""),
]
TRY = """
import json, sys
from pathlib import Path
from tools.mutants import chooser, mutations
from tools.mutants.mutations import mutants_of
from tools.mutants.trial import Trial
mutations.A_PLACE, mutations.A_LINE, chooser.LEAST = 2, 8, 0.1
root = Path(sys.argv[1])
made = mutants_of("src/tank.py", (root / "src/tank.py").read_text())
made = [mutant for mutant in made if mutant.becomes in sys.argv[2:]]
outcomes = Trial(root, ("src",), ("tests",), False, root / "kept", lambda outcome: None).judge(made)
print(json.dumps([(*o.mutant.key[1:], o.killer) for o in outcomes]))
"""


def mutants_of(file: str, source: str) -> list[Mutant]:
    from tools.mutants import mutations  # noqa: PLC0415 - not for workers without these tests

    return mutations.mutants_of(file, source)


def texts(source: str) -> set[str]:
    return {mutant.becomes for mutant in mutants_of("a.py", source)}


@pytest.fixture(scope="module")
def fates(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], str]:
    """What killed each mutant of the tiny project, by its function and the line that it makes."""
    root = tmp_path_factory.mktemp("project")
    return made_once(tmp_path_factory, "fates", lambda: judged(root))


def judged(root: Path) -> dict[tuple[str, str], str]:
    (root / "src").mkdir()
    (root / "tests").mkdir()
    (root / "src/tank.py").write_text(CODE)
    (root / "tests/test_tank.py").write_text(TESTS)
    (root / "conftest.py").write_text("import sys\nsys.path.insert(0, __file__[:-11] + 'src')\n")
    (root / "pytest.ini").write_text("[pytest]\naddopts = --import-mode=importlib\n")
    command = [sys.executable, "-B", "-c", TRY, str(root), *(becomes for _, becomes, _ in FATES)]
    plain = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # the tiny tests need none
    done = subprocess.run(command, cwd=ROOT, env=plain, capture_output=True, text=True, check=True)
    files = {str(p.relative_to(root)) for p in root.rglob("*") if p.is_file()}
    files -= {file for file in files if file.startswith("kept/")}
    assert files == {"src/tank.py", "tests/test_tank.py", "conftest.py", "pytest.ini"}
    assert (root / "src/tank.py").read_text() == CODE
    return {(function, becomes): killer for function, _, becomes, killer in json.loads(done.stdout)}


@pytest.mark.parametrize(("function", "becomes", "killer"), FATES)
def test_mutant_dies_of_the_test_that_notices_it(
    fates: dict[tuple[str, str], str], function: str, becomes: str, killer: str
) -> None:
    assert fates[function, becomes].rpartition("::")[2] == killer


def test_a_test_that_fails_anyway_kills_nothing(fates: dict[tuple[str, str], str]) -> None:
    assert not any("that_" in killer for killer in fates.values())


def test_docstrings_annotations_messages_and_words_are_left_alone() -> None:
    source = '''def f(a: "int" = None) -> "str":
    """Adds 1."""
    logger.info("a", 1)
    raise ValueError("b" + str(1))

Alias = dict[int, 1]
help = add(help="c", strict=True)
words = "in a row"
'''
    assert not texts(source)


def test_kinds_of_mutations(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tools.mutants.mutations.A_PLACE", 2)
    monkeypatch.setattr("tools.mutants.mutations.A_LINE", 8)
    made = texts(
        "def f(a, b, c):\n    if a < b and not c:\n        g(a, key=b)\n    return a * b, 'key'\n"
    )
    assert made >= {"if a <= b and not c:", "if a < b and c:", "pass"}
    assert {"return a / b, 'key'", "return a, 'key'", "return b, 'key'"} & made
    assert "return a * b, 'keyX'" in made
    assert texts("a = 1\n") == {"a = 0", "a = 2"}
    assert texts("for a in b:\n    continue\n") >= {"break"}
    assert "a = b == (d, c)" in texts("a = b == (c, d)\n")
    assert "a = b not in (d, c)" not in texts("a = b not in (c, d)\n"), "a membership has no order"


class Fate:
    """In place of trials: the mutants of lines that begin with "a" survive."""

    def __init__(self, *_: object) -> None: ...

    def judge(self, mutants: list[Mutant]) -> list[Outcome]:
        return [Outcome(m, "" if m.line.startswith("a") else "test_b", ()) for m in mutants]


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A tree with one module of twelve mutants at the least, of which those of two lines survive."""
    (tmp_path / "a.py").write_text("a = 1\n" + "".join(f"b{n} = True\n" for n in range(20)))
    monkeypatch.setattr(command, "ROOT", tmp_path)
    monkeypatch.setattr(command, "Trial", Fate)
    return tmp_path


def mutants(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["mutants", *words])
    return command.main()


def test_a_room_passes_from_the_threshold_on(
    tree: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert mutants(monkeypatch, "a.py") == 0
    assert "| elsewhere | 21 | 20 | 95.2 % |" in capsys.readouterr().out
    (tree / "a.py").write_text((tree / "a.py").read_text().replace("b", "a", 5))
    assert mutants(monkeypatch, "a.py") == 1
    assert "elsewhere: fewer than 90 % were noticed" in capsys.readouterr().out
    few = {"small": (scores.FEWEST - 1, 0)}
    assert scores.below(few) == []


def test_each_mutant_is_in_one_draw(
    tree: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert tree.is_dir()
    for draw in ("0", "1", "2"):
        mutants(monkeypatch, "a.py", "--one-in", "3", "--draw", draw)
    tried = [int(line.split()[2]) for line in capsys.readouterr().out.splitlines() if "to try" in line]
    assert sum(tried) == 21
    for wrong in (["--draw", "1"], ["--one-in", "2", "--draw", "-1"], ["--one-in", "0"]):
        with pytest.raises(SystemExit, match="2"):
            mutants(monkeypatch, "a.py", *wrong)


def test_changed_are_the_files_that_differ_from_the_base(tmp_path: Path) -> None:
    def git(*words: str) -> None:
        who = ["-c", "user.name=a", "-c", "user.email=a@b"]
        subprocess.run(["git", *who, *words], cwd=tmp_path, check=True, capture_output=True)  # noqa: S607

    git("init", "-b", "main")
    for name in ("same", "committed", "edited"):
        (tmp_path / name).write_text("a")
    git("add", ".")
    git("commit", "-m", "one")
    git("checkout", "-b", "other")
    (tmp_path / "committed").write_text("b")
    git("commit", "-a", "-m", "two")
    (tmp_path / "edited").write_text("b")
    (tmp_path / "new").write_text("b")
    assert changed_since(None, tmp_path) == {"committed", "edited", "new"}
    assert changed_since("HEAD", tmp_path) == {"edited", "new"}


def test_every_module_has_tests_that_are_to_notice_its_mutants() -> None:
    for file in modules():
        room = room_of(file)
        assert room.name != "elsewhere"
        assert room.tests, file
