"""Mutants of a tiny project, and the list of survivors of this one."""

import json
import os
import re
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.support.once import made_once
from tools.mutants import __main__ as command
from tools.mutants import session, survivors
from tools.mutants.chooser import Chooser, Timed
from tools.mutants.journal import Journal, Outcome
from tools.mutants.mutant import Mutant
from tools.mutants.scope import PACKAGES, ROOT, Package, changed_since, modules_of
from tools.mutants.session import Trace
from tools.mutants.survivors import LISTED, SCORES, TABLE, Score, complaints, listed, record, recorded
from tools.mutants.trial import patiently

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
    (
        "",
        "_HALF = 4.6875 # l",
        "test_lack",
    ),  # another constant, which others have imported, is made of it
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


def test_slow_tests_that_share_a_mutants_words_come_before_cheaper_ones(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("def fill(tank):\n    tank.level = 1\n")
    tests = "def test_other():\n    pass\n\n\ndef test_fill(tank):\n    assert tank.level\n"
    (tmp_path / "test_b.py").write_text(tests)
    other, fill = "test_b.py::test_other", "test_b.py::test_fill[1]"
    covered = {str(tmp_path / "a.py"): {2: {other, fill}}}
    chooser = Chooser(tmp_path, Trace(covered, {other: 4.0, fill: 5.0}), {})
    mutant = mutants_of("a.py", (tmp_path / "a.py").read_text())[0]
    assert [test for test, _ in chooser.tests(mutant)] == [fill, other]


def test_of_many_tests_that_may_use_a_constant_those_about_its_class_come_first(tmp_path: Path) -> None:
    (tmp_path / "fluids.py").write_text("class Acid:\n    promise = 1\n")
    tests = "def test_promise(name):\n    assert promise(name)\n"
    (tmp_path / "test_all.py").write_text(tests)
    names = [f"test_all.py::test_promise[{n}-{name}]" for n in range(9) for name in ("water", "acid")]
    slow = "test_all.py::test_promise[huge-acid]"
    (tmp_path / "test_page.py").write_text("def test_page():\n    pass\n")
    page = "test_page.py::test_page"  # which shows what others have made of it, maybe
    chooser = Chooser(tmp_path, Trace({}, dict.fromkeys(names, 4.0) | {slow: 14.0, page: 0.1}), {})
    chooser.runs_at_import = lambda mutant: True  # type: ignore[method-assign] # noqa: ARG005
    mutant = mutants_of("fluids.py", (tmp_path / "fluids.py").read_text())[0]
    chosen = [test for test, _ in chooser.tests(mutant)]
    assert chosen[0] == page  # the only quick one
    assert len(chosen) == 8  # half a minute
    assert all("-acid]" in test for test in chosen[1:])


def test_what_does_not_fit_into_the_time_leaves_it_to_quicker_ones(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("def fill(tank):\n    tank.level = 1\n")
    costs = {"test_b.py::test_fill_level": 4.0, "test_b.py::test_fill": 14.0, "test_b.py::test_b": 10.0}
    said = ("fill(tank).level", "fill(tank)", "fill")
    tests = [f"def {t[11:]}(tank):\n    {w}\n" for t, w in zip(costs, said, strict=True)]
    (tmp_path / "test_b.py").write_text("\n".join(tests))
    chooser = Chooser(tmp_path, Trace({str(tmp_path / "a.py"): {2: set(costs)}}, costs), {})
    mutant = mutants_of("a.py", (tmp_path / "a.py").read_text())[0]
    assert [test[11:] for test, _ in chooser.tests(mutant)] == ["test_fill_level", "test_b"]


def test_what_ran_out_of_time_is_tried_again_with_more_and_only_then_dead() -> None:
    mutants = mutants_of("a.py", "a = 1\nb = 2\nc = 3\n")
    needed = dict(zip(mutants, (1.0, 3.0, 1e9), strict=False))

    def attempt(choice: tuple[Mutant, Timed]) -> str:
        mutant, [(test, seconds)] = choice
        if seconds < needed[mutant]:
            os.kill(os.getpid(), signal.SIGKILL)
        return test if mutant is mutants[0] else ""

    choices = [(mutant, [("test", 2.0)]) for mutant in needed]
    told = {mutant: killer for (mutant, _), killer in patiently(choices, attempt)}
    assert told == dict(zip(needed, ("test", "", None), strict=True))


def test_what_others_did_meanwhile_costs_a_test_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    now = os.times_result((1.0, 0.5, 0.25, 0.25, 100.0))
    monkeypatch.setattr(os, "times", lambda: now)
    for queued, cost in ((0.0, 12.0), (90.0, 3.0)):
        monkeypatch.setattr(session, "_queued", lambda queued=queued: queued)
        assert session._seconds() == cost


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


def test_what_was_found_before_an_interruption_is_not_tried_again(tmp_path: Path) -> None:
    one, other = mutants_of("a.py", "def f(a):\n    return a + 1\n\n\ndef g(a):\n    return a > 1\n")[:2]
    journal = Journal(tmp_path / "kept/journal")
    assert journal.outcomes([one]) == []
    for killer in ("test_flaky", ""):
        journal.write(Outcome(one, killer, ("test_flaky", "test_a")))
    assert journal.outcomes([other, one]) == [Outcome(one, "", ("test_flaky", "test_a"))]


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


def test_same_code_gives_the_same_mutants_few_on_a_line_wherever_it_stands() -> None:
    line = "    return f(a + b * c, d - e / g, [h, i], j=1, k=2.0)\n"
    one = mutants_of("a.py", f"def t():\n{line}")
    other = mutants_of("a.py", f"import x\n\ndef t():\n{line}")
    assert [mutant.key for mutant in one] == [mutant.key for mutant in other]
    assert max(Counter(mutant.number for mutant in one).values()) == 3


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A tree whose one module has two mutants, both of which survive; scores are not kept."""

    class Survival:
        def __init__(self, *_: object) -> None: ...

        def judge(self, mutants: list[Mutant]) -> list[Outcome]:
            return [Outcome(mutant, "", ()) for mutant in mutants]

    (tmp_path / "a.py").write_text("a = 1\nb = True\n")
    (tmp_path / "list.toml").write_text("")
    monkeypatch.setattr(command, "ROOT", tmp_path)
    monkeypatch.setattr(command, "LISTED", tmp_path / "list.toml")
    monkeypatch.setattr(command, "Trial", Survival)
    monkeypatch.setattr(survivors, "record", lambda _: None)
    return tmp_path


def mutants(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["mutants", *words])
    return command.main()


def test_survivors_fail_the_run_until_they_are_listed(
    tree: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert mutants(monkeypatch, "a.py", "--list") == 1
    assert "| elsewhere | 2 | 0 | 0 | 0.0 % |" in capsys.readouterr().out
    entries = listed(tree / "list.toml")
    assert {entry.key for entry in entries} == {
        ("a.py", "", "a = 1", mutants_of("a.py", "a = 1\n")[0].becomes),
        ("a.py", "", "b = True", "b = False"),
    }
    assert mutants(monkeypatch, "a.py") == 0
    assert "| elsewhere | 2 | 0 | 2 | 0.0 % |" in capsys.readouterr().out
    assert [one.rpartition(": ")[2] for one in complaints(entries, tree)] == ["no reason is given"] * 2
    assert mutants(monkeypatch, "a.py", "--listed") == 0
    assert "1 modules, 2 mutants to try" in capsys.readouterr().out


def test_each_mutant_is_in_one_draw_and_there_are_no_others(
    tree: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for draw in ("0", "1", "2"):
        mutants(monkeypatch, "a.py", "--list", "--one-in", "3", "--draw", draw)
    tried = re.findall(r"modules, (\d) mutants", capsys.readouterr().out)
    assert sum(map(int, tried)) == len(listed(tree / "list.toml")) == 2
    for wrong in (["--draw", "1"], ["--one-in", "2", "--draw", "-1"], ["--one-in", "0"]):
        with pytest.raises(SystemExit, match="2"):
            mutants(monkeypatch, "a.py", *wrong)
    assert "--draw 1: the draws of --one-in are 0 to 0" in capsys.readouterr().err


def test_an_entry_without_its_mutant_is_refused(
    tree: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    mutants(monkeypatch, "a.py", "--list")
    (tree / "a.py").write_text("b = True\n")
    assert mutants(monkeypatch, "a.py") == 1
    assert "listed, but no such mutant any more" in capsys.readouterr().out
    told = complaints(listed(tree / "list.toml"), tree)
    assert "a.py: : a = 1: the line does not stand there any more" in told
    mutants(monkeypatch, "a.py", "--list")
    assert [entry.key[2] for entry in listed(tree / "list.toml")] == ["b = True"]


def test_teller_names_place_change_and_tests(capsys: pytest.CaptureFixture[str]) -> None:
    mutant = mutants_of("a.py", "\na = 1\n")[0]
    tell = command._Teller(2, set())
    tell(Outcome(mutant, "", tuple("abcdefg")))
    tell(Outcome(mutant, "test", ("a",)))
    told = capsys.readouterr().out
    assert told == f"a.py:2: a = 1  ->  {mutant.becomes}\n    a, b, c, d, e and 2 more\n0 left\n"


def test_wrong_file_or_revision_is_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert mutants(monkeypatch, "no/such.py") == 2
    assert mutants(monkeypatch, "--base", "no-such-revision") == 2
    first, second, *_ = capsys.readouterr().out.splitlines()
    assert first == "mutants: no such file: no/such.py"
    assert second.startswith("mutants: fatal: ")


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


def test_scores_are_kept_by_file_and_their_table_tells_packages(tmp_path: Path) -> None:
    document, scores = tmp_path / "doc.md", tmp_path / "scores.json"
    document.write_text("before\n\n" + survivors.table({}, {}) + "| old | 2 |\n\nafter\n")
    first, second = modules_of(PACKAGES[0])[:2]
    record({first: Score(8, 6, 2), second: Score(2, 0, 0), "gone.py": Score(1, 0, 0)}, scores, document)
    record({second: Score(2, 1, 1)}, scores, document)
    assert recorded(scores) == {first: Score(8, 6, 2), second: Score(mutants=2, killed=1, listed=1)}
    text = document.read_text()
    assert text.startswith("before\n\n| package")
    assert text.endswith(f"|\n| {PACKAGES[0].name} | 10 | 7 | 3 | 70.0 % |\n\nafter\n")
    assert "old" not in text


def test_every_package_has_modules_and_tests_and_no_module_has_two_packages() -> None:
    modules = [file for package in PACKAGES for file in modules_of(package)]
    assert all(
        modules_of(Package("", (pattern,))) for package in PACKAGES for pattern in package.modules
    )
    assert len(set(modules)) == len(modules)
    assert all((ROOT / tests).exists() for package in PACKAGES for tests in package.tests)


def test_listed_survivors_are_true_to_the_code() -> None:
    assert not complaints(listed(LISTED))


def test_document_shows_the_scores_of_every_package() -> None:
    if not SCORES.exists():
        pytest.skip("make mutants ARGS=--all has not been run to its end yet")
    scores, packages = recorded(SCORES), survivors.scope()
    assert scores.keys() == packages.keys(), "`make mutants` tries what is new and forgets what is gone"
    assert survivors.table(scores, packages) in TABLE.read_text()
    for name, score in survivors.by_package(scores, packages).items():
        assert score.killed_percent >= 92, name
