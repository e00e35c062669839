"""Which mutants the tests notice.

Everything is collected once; each mutant is tried in a fork of that process, by the tests that execute
its line. There, the code of its function is put in the place of the original's, so that whoever has
imported or wrapped the function calls the mutant. What runs at import - constants, defaults, fields -
cannot be mended afterwards: such a mutant is imported from the start, in a fork that knows only other
people's packages.
"""

import contextlib
import gc
import hashlib
import importlib
import os
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import coverage

from tools.mutants.chooser import Chooser, Timed
from tools.mutants.forks import in_forks
from tools.mutants.journal import Journal, Outcome
from tools.mutants.mutant import Mutant
from tools.mutants.session import DIED, Session, Trace
from tools.mutants.swap import Importer, functions_of, swap

AT_ONCE = 2  # processes
LIKELY = 2  # test files
SECOND_PATIENCE = 4.0  # for what took too long, maybe because the machine had other work
PLAIN_PATIENCE = 4.0  # kernels that nobody compiles are slow
_BROKEN = "import"  # what has noticed a mutant with which tests cannot be imported
_AT_IMPORT = "at import"  # what a fork answers whose mutant is not in a function

Choice = tuple[Mutant | None, Timed]  # a mutant and its tests; None for the code as it is


@dataclass(frozen=True)
class Trial:
    """Mutants of one tree and the tests that are to notice them.

    Attributes:
        root: The folder of the tree.
        sources: Folders with the code, from the root.
        tests: Files and folders with tests, likewise.
        plain: Whether numba compiles nothing.
        kept: A folder for what tests cover and for outcomes, for the next time.
        tell: Is told each outcome as it comes.
    """

    root: Path
    sources: tuple[str, ...]
    tests: tuple[str, ...]
    plain: bool
    kept: Path
    tell: Callable[[Outcome], None]

    def judge(self, mutants: list[Mutant]) -> list[Outcome]:
        """Tries all mutants.

        Raises:
            RuntimeError: A test fails without a mutant, or the tests cannot be run.
        """
        known = self._journal.outcomes(mutants)
        for outcome in known:
            self.tell(outcome)
        tried = {outcome.mutant for outcome in known}
        new = [mutant for mutant in mutants if mutant not in tried]
        if not new:
            return known
        ((_, outcomes),) = in_forks([new], self._judge, at_once=1, quiet=False)
        if outcomes is None:
            raise RuntimeError("the process that runs the tests died")
        return known + outcomes

    @cached_property
    def _journal(self) -> Journal:
        """Of the code and the tests as they stand."""
        return Journal(self.kept / f"outcomes-{self._digest(every=True)}.jsonl")

    def _judge(self, mutants: list[Mutant]) -> list[Outcome]:
        if self.plain:
            os.environ["NUMBA_DISABLE_JIT"] = "1"
        ((_, answer),) = in_forks([mutants], self._in_session, at_once=1, quiet=False)
        if answer is None:
            raise RuntimeError("the process that runs the tests died")
        outcomes, left, imported = answer
        for name in imported if left else ():
            with contextlib.suppress(Exception):
                importlib.import_module(name)
        return outcomes + self._tried_at_import(left)

    def _tried_at_import(self, choices: list[tuple[Mutant, Timed]]) -> list[Outcome]:
        """Tries mutants that are imported; again without the tests that fail without a mutant too."""
        outcomes: dict[Mutant, Outcome] = {}
        while choices:
            for (mutant, tests), killer in patiently(choices, self._imported):
                outcomes[mutant] = self._outcome(mutant, tests, killer)
            killed_by = {mutant: outcomes[mutant].killer for mutant, _ in choices}
            limits = {one[0]: one for _, tests in choices for one in tests}
            killers = [[limits[name]] for name in sorted(set(killed_by.values()) & limits.keys())]
            failing = set()
            for (_, ((name, _),)), failed in in_forks(
                [(None, tests) for tests in killers], self._imported, at_once=AT_ONCE
            ):
                if failed != "":
                    sys.stderr.write(f"{name} fails without a mutant and is left out\n")
                    failing.add(name)
            choices = [
                (mutant, [one for one in tests if one[0] not in failing])
                for mutant, tests in choices
                if killed_by[mutant] in failing
            ]
        return list(outcomes.values())

    def _outcome(self, mutant: Mutant, tests: Timed, killer: str | None) -> Outcome:
        outcome = Outcome(mutant, DIED if killer is None else killer, tuple(test for test, _ in tests))
        self._journal.write(outcome)
        self.tell(outcome)
        return outcome

    def _in_session(
        self, mutants: list[Mutant]
    ) -> tuple[list[Outcome], list[tuple[Mutant, Timed]], list[str]]:
        """Outcomes, mutants that are left for _imported, and the modules that it can import before."""
        include = [f"{self.root / source}/*" for source in self.sources]
        cover = coverage.Coverage(data_file=None, include=include, config_file=False)
        cover.set_option("run:disable_warnings", ["no-data-collected"])
        cover.start()
        outcomes: list[Outcome] = []
        left: list[tuple[Mutant, Timed]] = []
        imported: list[str] = []

        def serve(session: Session) -> None:
            cover.stop()
            imported.extend(_others())
            data = cover.get_data()
            at_import = {file: set(data.lines(file) or ()) for file in data.measured_files()}
            patience = PLAIN_PATIENCE if self.plain else 1.0
            chooser = Chooser(self.root, self._trace(session, include), at_import, patience)
            again = mutants
            while again:
                outcomes.extend(self._swapped(session, again, chooser, left))
                again = _unsound(session, outcomes, chooser)
                outcomes[:] = [one for one in outcomes if one.mutant not in again]

        with Path(os.devnull).open("w") as nothing, contextlib.redirect_stdout(nothing):
            Session(serve).run(
                [f"--rootdir={self.root}", *(str(self.root / test) for test in self.tests)]
            )
        return outcomes, left, imported

    def _trace(self, session: Session, include: list[str]) -> Trace:
        """What all tests cover. That of a test file is kept for as long as only other ones change."""
        began = time.monotonic()
        files: dict[str, list[str]] = defaultdict(list)
        for test in session.items:
            files[test.partition("::")[0]].append(test)
        trace, common = Trace(), self._digest()
        kept = {file: self.kept / f"{self._digest(file, common)}.json" for file in files}
        for path in kept.values():
            if path.exists():
                trace.add(Trace.load(path))
        new = [file for file, path in kept.items() if not path.exists()]
        for file, part in in_forks(
            new, lambda file: session.trace(files[file], include), at_once=AT_ONCE
        ):
            if part is None:
                sys.stderr.write(f"{file} does not run to its end here and is left out\n")
            else:
                part.save(kept[file])
                trace.add(part)
        seconds = time.monotonic() - began
        sys.stderr.write(f"{len(trace.costs)} tests pass, {len(new)} files run, {seconds:.0f} s\n")
        return trace

    def _digest(self, file: str = "", common: str = "", *, every: bool = False) -> str:
        """A hash of one test file; if none is named, of all code but test files, or of these too."""
        parts = [self.root / part for part in (*self.sources, *self.tests)]
        some = {p for part in parts for p in ([part] if part.is_file() else part.rglob("*.py"))}
        paths = [self.root / file] if file else sorted(some)
        used = [path for path in paths if file or every or not path.name.startswith("test_")]
        texts = (path.read_bytes() for path in used)
        return hashlib.sha256(f"{common}{file}{self.plain}".encode() + b"".join(texts)).hexdigest()[:24]

    def _swapped(
        self,
        session: Session,
        mutants: list[Mutant],
        chooser: Chooser,
        left: list[tuple[Mutant, Timed]],
    ) -> list[Outcome]:
        """Tries the mutants of functions; puts the others aside."""
        outcomes: list[Outcome] = []
        functions = functions_of({str(self.root / mutant.file) for mutant in mutants})
        gc.freeze()  # forks share what no collector touches

        def jobs() -> Iterator[tuple[Mutant, Timed]]:
            for mutant in mutants:
                tests = chooser.tests(mutant)
                if not tests:
                    outcomes.append(self._outcome(mutant, tests, ""))
                elif chooser.runs_at_import(mutant):
                    left.append((mutant, tests))
                else:
                    yield mutant, tests

        def attempt(job: tuple[Mutant, Timed]) -> str:
            mutant, tests = job
            whole = swap(str(self.root / mutant.file), mutant, functions)
            return session.first_failure(tests) if whole else _AT_IMPORT

        for (mutant, tests), killer in patiently(jobs(), attempt):
            if killer == _AT_IMPORT:
                left.append((mutant, tests))
            else:
                outcomes.append(self._outcome(mutant, tests, killer))
                chooser.remember(mutant, killer or "")
        return outcomes

    def _imported(self, choice: Choice) -> str:
        """The first test that fails where a mutant is imported from the start."""
        mutant, tests = choice
        if mutant is not None:
            sys.meta_path.insert(0, Importer(self.root, mutant))
        files = list(dict.fromkeys(test.partition("::")[0] for test, _ in tests))
        # Most mutants die of the first tests: to collect all the files takes longer than these.
        for some in (files[:LIKELY], files[LIKELY:]):
            if some and (failure := self._first_failure_in(some, tests)):
                return failure
        return ""

    def _first_failure_in(self, files: list[str], tests: Timed) -> str:
        """The first test of these files that fails where they are imported now."""
        failure = [_BROKEN]

        def serve(session: Session) -> None:
            if session.is_whole:
                failure[0] = session.first_failure(_collected(tests, session.items))

        Session(serve).run([f"--rootdir={self.root}", *(str(self.root / file) for file in files)])
        return failure[0]


def patiently(
    choices: Iterable[tuple[Mutant, Timed]], attempt: Callable[[tuple[Mutant, Timed]], str]
) -> Iterator[tuple[tuple[Mutant, Timed], str | None]]:
    """Results as of in_forks; what died is tried again, alone and with more time: it may only be slow.

    Args:
        choices: Mutants and their tests.
        attempt: Returns the test that fails.
    """
    died: list[tuple[Mutant, Timed]] = []
    for choice, killer in in_forks(choices, attempt, at_once=AT_ONCE):
        if killer in {None, DIED}:
            mutant, tests = choice
            died.append((mutant, [(test, SECOND_PATIENCE * seconds) for test, seconds in tests]))
        else:
            yield choice, killer
    yield from in_forks(died, attempt, at_once=1)


def _collected(tests: Timed, items: Iterable[str]) -> Timed:
    """Those of the tests that there are; for one that is not, its function's with new parameters."""
    found, wanted = list(items), dict(tests)
    missing = {name.partition("[")[0]: limit for name, limit in tests if name not in found}
    names = [name for name in found if name not in wanted and name.partition("[")[0] in missing]
    renamed = [(name, missing[name.partition("[")[0]]) for name in names]
    return [one for one in tests if one[0] in found] + renamed


def _unsound(session: Session, outcomes: list[Outcome], chooser: Chooser) -> list[Mutant]:
    """Mutants noticed by a test that fails without one, too; such a test is not used any more."""
    killers = sorted({outcome.killer for outcome in outcomes} & chooser.trace.costs.keys())
    failing = set()
    for killer, failed in in_forks(
        killers, lambda test: session.first_failure(chooser.limits([test])), at_once=AT_ONCE
    ):
        if failed != "":
            sys.stderr.write(f"{killer} fails without a mutant and is left out\n")
            chooser.distrust(killer)
            failing.add(killer)
    return [outcome.mutant for outcome in outcomes if outcome.killer in failing]


def _others() -> list[str]:
    """Modules of other people's packages that are imported now."""
    modules = list(sys.modules.items())
    return [name for name, module in modules if "site-packages" in str(getattr(module, "__file__", ""))]
