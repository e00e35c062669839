"""Which tests a mutant is given to, and in which order."""

import ast
import re
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path

from tools.mutants.mutant import Mutant
from tools.mutants.session import Trace

SLOW = 3.0  # [s]; a slower test comes last
BUDGET = 6.0  # [s] of quick tests for one mutant
# [s] of other tests, for one that has survived these; first those that share its words
LAST_BUDGET = 15.0
LEAST = 1.0  # [s] that any test may take

Timed = list[tuple[str, float]]  # tests and the seconds that each may take


class Chooser:
    """Finds the tests for a mutant, those first that are likely to notice it.

    Args:
        root: The folder of the tree.
        trace: What each test covers.
        at_import: Lines that run when modules are imported, by file.
        patience: How much longer than usual tests may take.
    """

    def __init__(
        self, root: Path, trace: Trace, at_import: dict[str, set[int]], patience: float = 1.0
    ) -> None:
        self.trace, self._slow = trace, SLOW * patience
        self._budget, self._last_budget = BUDGET * patience, LAST_BUDGET * patience
        self._root, self._at_import = root, at_import
        self._statements: dict[str, dict[int, tuple[range, set[str]]]] = {}
        self._killers: Counter[tuple[str, str, str]] = Counter()
        self._distrusted: set[str] = set()
        self._words: dict[str, set[str]] = defaultdict(set)
        self._said: dict[str, set[str]] = {}  # names in a test, by its own without parameters
        for file, lines in trace.lines.items():
            texts = Path(file).read_text().splitlines()
            for line, tests in lines.items():
                # Code that is compiled under a file's name may have more lines than the file.
                text = texts[line - 1] if line <= len(texts) else ""
                for word in re.findall(r"\w+", text):
                    self._words[word] |= tests
        by_file: dict[str, set[str]] = defaultdict(set)
        for test in trace.costs:
            by_file[test.partition("::")[0]].add(test)
        for file, some in by_file.items():
            source = (root / file).read_text()
            for word in set(re.findall(r"\w+", source)):
                self._words[word] |= some
            for node in ast.parse(source).body:
                if isinstance(node, ast.FunctionDef):
                    said = source.splitlines()[node.lineno - 1 : node.end_lineno]
                    self._said[f"{file}::{node.name}"] = _names("\n".join(said))

        self._said_by = Counter(word for test in trace.costs for word in self._speech(test))

    def runs_at_import(self, mutant: Mutant) -> bool:
        """Whether a mutant's statement is executed before any test."""
        lines, _ = self._statement(mutant)
        return not self._at_import.get(str(self._root / mutant.file), set()).isdisjoint(lines)

    def tests(self, mutant: Mutant) -> Timed:
        """Tests in the order in which they are to run, within the budget, and what each may take."""
        lines, names = self._statement(mutant)
        covered = self.trace.lines.get(str(self._root / mutant.file), {})
        tests = set().union(*(covered.get(line, ()) for line in lines))
        if self.runs_at_import(mutant):
            tests = tests.union(*(self._words.get(name, ()) for name in names))
        related = tests
        if self.runs_at_import(mutant):  # other modules may have made something of it for anybody
            tests = set(self.trace.costs)
        tests = tests - self._distrusted
        costs = self.trace.costs
        quick = {test for test in tests if costs[test] <= self._slow} - self.trace.slow
        mirror = f"test_{Path(mutant.file).stem}.py"

        def rank(test: str) -> tuple[int, bool, bool, float]:
            return (
                -self._killers[mutant.file, mutant.function, test],
                test not in related,
                f"/{mirror}:" not in test,
                costs[test],
            )

        about = _names(mutant.line, mutant.function, Path(mutant.file).stem, *names)

        def unrelated(test: str) -> tuple[float, float]:
            return -sum(1 / self._said_by[word] for word in about & self._speech(test)), costs[test]

        # Nothing tells which of all tests notices what runs at import: twice as many may try.
        times = 2 if self.runs_at_import(mutant) else 1
        chosen = self._within(times * self._budget, sorted(quick, key=rank))
        others = sorted(tests - set(chosen) - self.trace.slow, key=unrelated)
        chosen += self._within(times * self._last_budget, others)
        return self.limits(chosen or sorted(tests, key=costs.__getitem__)[:3])

    def _speech(self, test: str) -> set[str]:
        """Names that a test says, in its parameters too."""
        name, _, parameters = test.partition("[")
        return self._said.get(name, set()) | _names(parameters)

    def _within(self, budget: float, tests: list[str]) -> list[str]:
        """The first test and those after it that fit in as well."""
        chosen: list[str] = []
        for test in tests:
            if not chosen or self.trace.costs[test] <= budget:
                chosen.append(test)
                budget -= self.trace.costs[test]
        return chosen

    def limits(self, tests: Iterable[str]) -> Timed:
        """Tests with the seconds that each may take."""
        return [(test, LEAST + 4 * self.trace.costs[test]) for test in tests]

    def remember(self, mutant: Mutant, killer: str) -> None:
        """What has noticed a mutant is likely to notice the next one of the same function."""
        self._killers[mutant.file, mutant.function, killer] += 1

    def distrust(self, test: str) -> None:
        """Gives a test to no mutant any more."""
        self._distrusted.add(test)

    def _statement(self, mutant: Mutant) -> tuple[range, set[str]]:
        """Lines of the statement around a mutant, without its body, and names that depend on it."""
        if mutant.file not in self._statements:
            self._statements[mutant.file] = _statements((self._root / mutant.file).read_text())
        default = range(mutant.number, mutant.number + 1), {mutant.function.rpartition(".")[2]}
        return self._statements[mutant.file].get(mutant.number, default)


def _names(*texts: str) -> set[str]:
    """Names in texts, in small letters: what a number or a short word is shared with tells nothing."""
    return {word.lower() for text in texts for word in re.findall(r"[^\W\d]\w{2,}", text)}


def _statements(source: str) -> dict[int, tuple[range, set[str]]]:
    """The lines of each line's statement, and the names that depend on it at import."""
    found: dict[int, tuple[range, set[str]]] = {}
    gives: list[tuple[set[str], set[str]]] = []  # names that a statement needs, and those it defines
    for node in ast.walk(ast.parse(source)):  # outer ones first
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            last = body[0].lineno - 1 if body else node.end_lineno or node.lineno
            lines, names = range(node.lineno, max(last, node.lineno) + 1), _defined(node)
            found |= dict.fromkeys(lines, (lines, names))
            gives.append((_needed(node), names))
    return {line: (lines, _given(names, gives)) for line, (lines, names) in found.items()}


def _defined(node: ast.stmt) -> set[str]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    targets = getattr(node, "targets", [getattr(node, "target", None)])
    return {n.id for t in targets if t for n in ast.walk(t) if isinstance(n, ast.Name)}


def _needed(node: ast.stmt) -> set[str]:
    """Names that a statement reads where it stands, so not those in the body of a function."""
    parts: list[ast.AST] = [node]
    if isinstance(node, ast.FunctionDef):
        parts = [*node.decorator_list, node.args]
    elif isinstance(node, ast.ClassDef):
        parts = [*node.decorator_list, *node.bases]
    return {n.id for part in parts for n in ast.walk(part) if isinstance(n, ast.Name)}


def _given(names: set[str], gives: list[tuple[set[str], set[str]]]) -> set[str]:
    """Names, and all that are made of them."""
    while True:
        more = names.union(*(defined for needed, defined in gives if needed & names))
        if more == names:
            return names
        names = more
