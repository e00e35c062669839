"""Which mutants the tests notice.

Everything is collected once; each mutant is tried in a fork of that process, by the tests that execute its
line. There, the code of its function is put in the place of the original's, so that whoever has
imported or wrapped the function calls the mutant. What runs at import - constants, defaults, fields -
cannot be mended afterwards: such a mutant is imported from the start, in a fork that knows only other
people's packages.
"""

import ast
import contextlib
import gc
import importlib
import importlib.util
import os
import re
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

import coverage

from tools.mutants.forks import in_forks
from tools.mutants.mutations import Mutant
from tools.mutants.session import DIED, Session, Trace

AT_ONCE = 2
SLOW = 3.0  # [s]; a slower test is used only for what no other covers
BUDGET = 20.0  # [s] of tests for one mutant
_AT_IMPORT = "at import"  # what a fork answers whose mutant is not in a function

Choice = tuple[Mutant, list[tuple[str, float]]]  # a mutant, its tests and the seconds that each may take


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant.

    Attributes:
        mutant: The mutant.
        killer: The test that failed, or how the process ended; empty if it survived.
        tests: The tests that were tried, or would have been.
    """

    mutant: Mutant
    killer: str
    tests: tuple[str, ...]


@dataclass(frozen=True)
class Trial:
    """Mutants of one tree and the tests that are to notice them.

    Attributes:
        root: The folder of the tree.
        sources: Files and folders with Python code, from the root.
        tests: Likewise, with tests.
        plain: Whether numba compiles nothing.
        tell: Is told each outcome as it comes.
    """

    root: Path
    sources: tuple[str, ...]
    tests: tuple[str, ...]
    plain: bool
    tell: Callable[[Outcome], None]

    def judge(self, mutants: list[Mutant]) -> list[Outcome]:
        """Tries all mutants.

        Raises:
            RuntimeError: Tests that fail without a mutant, or no tests at all.
        """
        if self.plain:
            os.environ["NUMBA_DISABLE_JIT"] = "1"
        ((_, answer),) = in_forks([mutants], self._collected, at_once=1, quiet=False)
        if answer is None:
            raise RuntimeError("the tests could not be collected")
        outcomes, left, imported = answer
        for name in imported:
            with contextlib.suppress(Exception):
                importlib.import_module(name)
        controls = {choice[0].file: (None, choice[1]) for choice in left}  # unchanged, they must pass
        for (mutant, tests), killer in in_forks([*controls.values(), *left], self._afresh, at_once=AT_ONCE):
            if mutant is not None:
                outcomes.append(self._outcome(mutant, tests, DIED if killer is None else killer))
            elif killer:
                raise RuntimeError(f"without a mutant fails {killer}")
        return outcomes

    def _outcome(self, mutant: Mutant, tests: list[tuple[str, float]], killer: str) -> Outcome:
        outcome = Outcome(mutant, killer, tuple(test for test, _ in tests))
        self.tell(outcome)
        return outcome

    def _collected(self, mutants: list[Mutant]) -> tuple[list[Outcome], list[Choice], list[str]]:
        """Outcomes, the mutants that are left for _afresh, and the modules that it may import before."""
        include = [f"{self.root / source}/*" for source in self.sources]
        cover = coverage.Coverage(data_file=None, include=include, config_file=False)
        cover.start()
        answer: list[Any] = []

        def serve(session: Session) -> None:
            cover.stop()
            at_import = _lines(cover)
            imported = [n for n, m in sys.modules.items() if "site-packages" in str(getattr(m, "__file__", ""))]
            answer.extend(([], [], imported))
            began = time.monotonic()
            trace = self._trace(session, include)
            sys.stderr.write(f"{len(trace.costs)} tests pass, {time.monotonic() - began:.0f} s\n")
            chooser = Chooser(self.root, trace, at_import)
            self._swapped(session, mutants, chooser, answer[0], answer[1])

        with Path(os.devnull).open("w") as nothing, contextlib.redirect_stdout(nothing):
            Session(serve).run([f"--rootdir={self.root}", *(str(self.root / test) for test in self.tests)])
        if not answer:
            raise RuntimeError("pytest collected nothing")
        return answer[0], answer[1], answer[2]

    def _trace(self, session: Session, include: list[str]) -> Trace:
        files: dict[str, list[str]] = defaultdict(list)
        for test in session.items:
            files[test.partition("::")[0]].append(test)
        trace = Trace()
        gc.freeze()
        for file, part in in_forks(files, lambda file: session.trace(files[file], include), at_once=AT_ONCE):
            if part is None:
                sys.stderr.write(f"{file} does not run to its end in a fork and is left out\n")
            else:
                trace.add(part)
        return trace

    def _swapped(
        self,
        session: Session,
        mutants: list[Mutant],
        chooser: "Chooser",
        outcomes: list[Outcome],
        left: list[Choice],
    ) -> None:
        """Tries the mutants of functions."""
        gc.unfreeze()
        functions = _functions({str(self.root / mutant.file) for mutant in mutants})
        gc.freeze()

        def jobs() -> Iterator[Choice]:
            for mutant in mutants:
                tests = chooser.tests(mutant)
                if not tests:
                    outcomes.append(self._outcome(mutant, tests, ""))
                elif chooser.runs_at_import(mutant):
                    left.append((mutant, tests))
                else:
                    yield mutant, tests

        def attempt(choice: Choice) -> str:
            mutant, tests = choice
            path = self.root / mutant.file
            if not _swap(str(path), mutant, functions):
                return _AT_IMPORT
            return session.first_failure(tests)

        for (mutant, tests), killer in in_forks(jobs(), attempt, at_once=AT_ONCE):
            if killer == _AT_IMPORT:
                left.append((mutant, tests))
                continue
            outcomes.append(self._outcome(mutant, tests, DIED if killer is None else killer))
            chooser.remember(mutant, killer or "")
        killers = sorted({o.killer for o in outcomes} & chooser.trace.costs.keys())
        for killer, failed in in_forks(killers, lambda k: session.first_failure(chooser.limits([k])), at_once=AT_ONCE):
            if failed or failed is None:
                raise RuntimeError(f"without a mutant fails {killer}")

    def _afresh(self, choice: tuple[Mutant | None, list[tuple[str, float]]]) -> str:
        """The first test that fails where a mutant is imported from the start."""
        mutant, tests = choice
        if mutant is not None:
            sys.meta_path.insert(0, _Importer(self.root, mutant))
        failure = ["import"]

        def serve(session: Session) -> None:
            failure[0] = session.first_failure([one for one in tests if one[0] in session.items])

        files = dict.fromkeys(str(self.root / test.partition("::")[0]) for test, _ in tests)
        Session(serve).run([f"--rootdir={self.root}", *files])
        return failure[0]


class Chooser:
    """Finds the tests for a mutant, those first that are likely to notice it.

    Args:
        root: The folder of the tree.
        trace: What each test covers.
        at_import: Lines that run when modules are imported, by file.
    """

    def __init__(self, root: Path, trace: Trace, at_import: dict[str, set[int]]) -> None:
        self.trace = trace
        self._root, self._at_import = root, at_import
        self._statements: dict[str, dict[int, tuple[range, set[str]]]] = {}
        self._killers: Counter[tuple[str, str, str]] = Counter()
        self._words: dict[str, set[str]] = defaultdict(set)
        for file, lines in trace.lines.items():
            texts = Path(file).read_text().splitlines()
            for line, tests in lines.items():
                for word in re.findall(r"\w+", texts[line - 1]):
                    self._words[word] |= tests
        by_file: dict[str, set[str]] = defaultdict(set)
        for test in trace.costs:
            by_file[test.partition("::")[0]].add(test)
        for file, some in by_file.items():
            for word in set(re.findall(r"\w+", (root / file).read_text())):
                self._words[word] |= some

    def runs_at_import(self, mutant: Mutant) -> bool:
        """Whether a mutant's statement is executed before any test."""
        lines, _ = self._statement(mutant)
        return not self._at_import.get(str(self._root / mutant.file), set()).isdisjoint(lines)

    def tests(self, mutant: Mutant) -> list[tuple[str, float]]:
        """Tests in the order in which they are to run, within the budget, and what each may take."""
        lines, names = self._statement(mutant)
        covered = self.trace.lines.get(str(self._root / mutant.file), {})
        tests = set().union(*(covered.get(line, ()) for line in lines))
        if self.runs_at_import(mutant):
            tests = tests.union(*(self._words.get(name, ()) for name in names))
        costs = self.trace.costs
        quick = {test for test in tests if costs[test] <= SLOW} - self.trace.slow
        mirror = f"test_{Path(mutant.file).stem}.py"

        def rank(test: str) -> tuple[int, bool, float]:
            return -self._killers[mutant.file, mutant.function, test], f"/{mirror}:" not in test, costs[test]

        chosen, total = [], 0.0
        for test in sorted(quick, key=rank) or sorted(tests, key=costs.__getitem__)[:3]:
            total += costs[test]
            if chosen and total > BUDGET:
                break
            chosen.append(test)
        return self.limits(chosen)

    def limits(self, tests: Iterable[str]) -> list[tuple[str, float]]:
        """Tests with the seconds that each may take."""
        return [(test, 2.0 + 4 * self.trace.costs[test]) for test in tests]

    def remember(self, mutant: Mutant, killer: str) -> None:
        """What has noticed a mutant is likely to notice the next one of the same function."""
        self._killers[mutant.file, mutant.function, killer] += 1

    def _statement(self, mutant: Mutant) -> tuple[range, set[str]]:
        """The lines of the statement around a mutant, without what it encloses, and the names it defines."""
        if mutant.file not in self._statements:
            self._statements[mutant.file] = _statements((self._root / mutant.file).read_text())
        default = range(mutant.number, mutant.number + 1), {mutant.function.rpartition(".")[2]}
        return self._statements[mutant.file].get(mutant.number, default)


def _statements(source: str) -> dict[int, tuple[range, set[str]]]:
    found: dict[int, tuple[range, set[str]]] = {}
    for node in ast.walk(ast.parse(source)):  # outer ones first
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            last = body[0].lineno - 1 if body else node.end_lineno or node.lineno
            targets = getattr(node, "targets", [getattr(node, "target", None)])
            names = {n.id for t in targets if t for n in ast.walk(t) if isinstance(n, ast.Name)}
            names |= {node.name} if isinstance(node, ast.FunctionDef | ast.ClassDef) else set()
            lines = range(node.lineno, max(last, node.lineno) + 1)
            found |= dict.fromkeys(lines, (lines, names))
    return found


def _lines(cover: coverage.Coverage) -> dict[str, set[int]]:
    data = cover.get_data()
    return {file: set(data.lines(file) or ()) for file in data.measured_files()}


class _Importer(MetaPathFinder):
    """Gives a mutant for its module."""

    def __init__(self, root: Path, mutant: Mutant) -> None:
        self._path, self._mutant = root / mutant.file, mutant

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Tells how to import a module; only the mutant's is imported another way."""
        if name.rpartition(".")[2] not in {self._path.stem, self._path.parent.name}:
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is None or spec.origin != str(self._path):
            return None
        source = self._mutant.apply(self._path.read_text())

        class Loader(SourceFileLoader):
            def get_code(self, fullname: str) -> CodeType:  # noqa: ARG002 - the protocol's
                return compile(source, self.path, "exec", dont_inherit=True)

        return importlib.util.spec_from_file_location(
            name, self._path, loader=Loader(name, str(self._path)),
            submodule_search_locations=spec.submodule_search_locations,
        )


Functions = dict[tuple[str, str, int], list[FunctionType]]


def _functions(files: set[str]) -> Functions:
    """All functions that there are of some files, by what their code says of itself."""
    found: Functions = defaultdict(list)
    for function in gc.get_objects():
        if type(function) is FunctionType and function.__code__.co_filename in files:
            found[_place(function.__code__)].append(function)
    return found


def _place(code: CodeType) -> tuple[str, str, int]:
    return code.co_filename, code.co_qualname, code.co_firstlineno


def _swap(path: str, mutant: Mutant, functions: Functions) -> bool:
    """Puts a mutant's code into the functions that there are; False if that is not enough."""
    source = Path(path).read_text()
    before, after = (
        compile(text, path, "exec", dont_inherit=True) for text in (source, mutant.apply(source))
    )
    try:
        pairs = list(_changed(before, after))
        for old, new, is_outermost in pairs:
            live = functions.get(_place(old), [])
            if is_outermost and not live:
                return False
            for function in live:
                function.__code__ = new
    except ValueError:  # code at the module's or a class's level, or another closure
        return False
    return True


def _changed(old: CodeType, new: CodeType, *, within: bool = False) -> Iterator[tuple[CodeType, CodeType, bool]]:
    """Pairs of functions' code that differ, and whether they stand in no other function.

    Raises:
        ValueError: Code differs that is no function's.
    """
    if _whole(old) == _whole(new):
        return
    is_function = bool(old.co_flags & 1)  # CO_OPTIMIZED
    inner_old, inner_new = _inner(old), _inner(new)
    if is_function:
        yield old, new, not within
    elif _shallow(old) != _shallow(new):
        raise ValueError
    if len(inner_old) == len(inner_new):
        for one, other in zip(inner_old, inner_new, strict=True):
            yield from _changed(one, other, within=within or is_function)


def _inner(code: CodeType) -> list[CodeType]:
    return [constant for constant in code.co_consts if isinstance(constant, CodeType)]


def _shallow(code: CodeType) -> tuple[object, ...]:
    """What a code does, but for the code in it; without line numbers."""
    constants = [repr(c) for c in code.co_consts if not isinstance(c, CodeType)]
    names = code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
    return code.co_code, constants, names, code.co_argcount, code.co_kwonlyargcount, code.co_flags


def _whole(code: CodeType) -> tuple[object, ...]:
    return _shallow(code), [_whole(inner) for inner in _inner(code)]
