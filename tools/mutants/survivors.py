"""Mutants that no test needs to notice, each with its reason, and the scores."""

import ast
import json
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import tomllib

from tools.mutants.scope import PACKAGES, ROOT, Package, modules_of

LISTED = ROOT / "tools/mutants/survivors.toml"
SCORES = ROOT / "tools/mutants/scores.json"
TABLE = ROOT / "docs/guarantees.md"
_HEAD = "| package | mutants | killed | listed | killed |\n|---|---|---|---|---|\n"

_FIELDS = ("file", "function", "line", "becomes", "reason")

Key = tuple[str, str, str, str]  # as Mutant.key
ELSEWHERE = Package("elsewhere", ())


@dataclass(frozen=True)
class Survivor:
    """An entry of the list.

    Attributes:
        key: What the mutant is, see Mutant.key.
        reason: Why no test needs to notice it.
    """

    key: Key
    reason: str


def listed(path: Path) -> list[Survivor]:
    """The list."""
    entries = tomllib.loads(path.read_text()).get("survivor", [])
    return [
        Survivor((e["file"], e["function"], e["line"], e["becomes"]), e.get("reason", ""))
        for e in entries
    ]


def update(path: Path, survived: Iterable[Key], gone: Collection[Key]) -> None:
    """Adds mutants to the list, whose reasons are still to be written, and removes others."""
    head = path.read_text().partition("[[")[0].rstrip()
    kept = [entry for entry in listed(path) if entry.key not in gone]
    entries = sorted([*kept, *(Survivor(key, "") for key in survived)], key=lambda entry: entry.key)
    text = [head]
    for entry in entries:
        fields = zip(_FIELDS, (*entry.key, entry.reason), strict=True)
        lines = (f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in fields)
        text.append("\n".join(("[[survivor]]", *lines)))
    path.write_text("\n\n".join(text) + "\n")


def complaints(entries: Iterable[Survivor], root: Path = ROOT) -> list[str]:
    """What is wrong with a list, by the code as it stands; quick, it makes no mutants."""
    found = []
    read = cache(lambda file: (root / file).read_text())
    parsed = cache(lambda file: ast.parse(read(file)))
    for entry in entries:
        file, function, line, becomes = entry.key
        told = f"{file}: {function}: {line}"
        if not entry.reason.strip():
            found.append(f"{told}: no reason is given")
        if line == becomes:
            found.append(f"{told}: nothing is changed")
        if not (root / file).is_file():
            found.append(f"{told}: there is no such file")
        elif line not in " ".join(_source(read(file), parsed(file), function).split()):
            found.append(f"{told}: the line does not stand there any more")
    return found


def _source(source: str, tree: ast.Module, function: str) -> str:
    """The code of what a qualified name means; of the whole file for the empty name."""
    nodes: list[ast.AST] = [tree]
    for name in function.split(".") if function else ():
        nodes = [n for node in nodes for n in _statements(node) if getattr(n, "name", None) == name]
    lines = source.splitlines()
    parts = [lines[n.lineno - 1 : n.end_lineno] for n in nodes if isinstance(n, ast.stmt)]
    return "\n".join(line for part in parts for line in part) if function else source


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """All below a node, at any depth."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (ast.stmt, ast.ExceptHandler, ast.match_case)):
            yield child
            yield from _statements(child)


@dataclass(frozen=True)
class Score:
    """How many mutants there are, how many died, how many of the others are listed."""

    mutants: int = 0
    killed: int = 0
    listed: int = 0

    @property
    def killed_percent(self) -> float:
        """Of all mutants."""
        return 100 * self.killed / max(self.mutants, 1)

    def __add__(self, other: "Score") -> "Score":
        return Score(
            self.mutants + other.mutants, self.killed + other.killed, self.listed + other.listed
        )


def scope() -> dict[str, Package]:
    """The package of every module that is mutated as a habit."""
    return {file: package for package in PACKAGES for file in modules_of(package)}


def by_package(scores: Mapping[str, Score], packages: Mapping[str, Package]) -> dict[str, Score]:
    """Sums over the files of each package, in the order of the scope.

    Args:
        scores: By file.
        packages: The package of each file.
    """
    sums: dict[str, Score] = {}
    for package in (*PACKAGES, ELSEWHERE):
        some = [score for file, score in scores.items() if packages[file].name == package.name]
        if some:
            sums[package.name] = sum(some, Score())
    return sums


def table(scores: Mapping[str, Score], packages: Mapping[str, Package]) -> str:
    """The scores of packages in Markdown; arguments as by_package."""
    rows = (
        f"| {name} | {s.mutants} | {s.killed} | {s.listed} | {s.killed_percent:.1f} % |\n"
        for name, s in by_package(scores, packages).items()
    )
    return _HEAD + "".join(rows)


def recorded(path: Path) -> dict[str, Score]:
    """The score of each file when its mutants were tried last; empty if there is no such record."""
    return (
        {f: Score(*score) for f, score in json.loads(path.read_text()).items()} if path.exists() else {}
    )


def record(scores: Mapping[str, Score], path: Path | None = None, document: Path | None = None) -> None:
    """Keeps the scores of files that are in the scope, and their table in a document."""
    path, document, packages = path or SCORES, document or TABLE, scope()
    kept = {f: s for f, s in (recorded(path) | dict(scores)).items() if f in packages}
    text = document.read_text()
    begin = text.index(_HEAD)
    end = text.find("\n\n", begin) + 1 or len(text)
    document.write_text(text[:begin] + table(kept, packages) + text[end:])
    rows = (f"  {json.dumps(file)}: {list(vars(kept[file]).values())}" for file in sorted(kept))
    path.write_text("{\n" + ",\n".join(rows) + "\n}\n")
