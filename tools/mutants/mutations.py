"""The mutations of a module: mutmut's operators and a few more, one a place at most.

What no test should hold is left alone: annotations, docstrings, errors and what is logged, any text
with a space in it, decorators, type aliases.
"""

import hashlib
import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any, ClassVar

import libcst as cst
import libcst.matchers as m
from libcst.metadata import (
    CodeRange,
    MetadataWrapper,
    ParentNodeProvider,
    WhitespaceInclusivePositionProvider,
)
from mutmut.mutation import mutators

from tools.mutants.mutant import Mutant

A_PLACE, A_LINE = 1, 3  # mutations at most; which, decides a hash of the code

_LOGGING = {"print", "debug", "info", "warn", "warning", "error", "critical", "fatal", "add_argument"}
_TYPING = {"TypeVar", "ParamSpec", "NewType", "cast"}
_UNMUTATED_ARGUMENTS = {"strict", "encoding", "help", "metavar", "description", "stacklevel", "unit"}
_COMMUTATIVE = {"min", "max", "math.dist", "math.hypot", "np.minimum", "np.maximum"}
_OPPOSITES = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}
_PAIRS = "min-max sin-cos floor-ceil any-all left-right minimum-maximum argmin-argmax append-appendleft"
_NAMES = {
    **dict(pair.split("-") for pair in _PAIRS.split()),
    **dict(pair.split("-")[::-1] for pair in _PAIRS.split()),
    "x": "y",
    "y": "z",
    "z": "x",
    "abs": "float",
    "round": "int",
    "sorted": "list",
}

_CLASSES = re.compile(r"\(((list|tuple|set|dict|int|float|str|[A-Z]\w+[a-z]\w*)(, |\)))+$")

Mutated = tuple[cst.CSTNode, str]  # what is replaced, and by what


def mutants_of(file: str, source: str) -> list[Mutant]:
    """All mutants of a module in their order; equal code gives equal mutants."""
    finder = _Finder(source)
    MetadataWrapper(cst.parse_module(source), unsafe_skip_copy=True).visit(finder)
    found: dict[str, Mutant] = {}
    for function, start, end, new in sorted(finder.found, key=lambda place: place[1:]):
        mutant = _shrunk(file, function, source, start, end, new)
        mutated = mutant.apply(source)
        if mutated != source and mutated not in found and _is_valid(mutated):
            found[mutated] = mutant
    by_line: dict[int, list[Mutant]] = {}
    for mutant in found.values():
        by_line.setdefault(mutant.number, []).append(mutant)
    return [mutant for some in by_line.values() for mutant in _chosen(some, A_LINE)]


def _chosen(mutants: list[Mutant], count: int) -> list[Mutant]:
    """Some of the mutants of a line, in their order."""
    ranked = sorted(mutants, key=lambda mutant: _hash(*mutant.key[1:]))
    return [mutant for mutant in mutants if mutant in ranked[:count]]


def _hash(*texts: str) -> bytes:
    return hashlib.sha256("|".join(texts).encode()).digest()


def _is_valid(source: str) -> bool:
    """Whether it compiles: a parser alone lets a `return` outside a function pass."""
    try:
        compile(source, "", "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return True


def _shrunk(file: str, function: str, source: str, start: int, end: int, new: str) -> Mutant:
    """The same replacement without what it leaves as it is at both ends."""
    while start < end and new and source[start] == new[0]:
        start, new = start + 1, new[1:]
    while start < end and new and source[end - 1] == new[-1]:
        end, new = end - 1, new[:-1]
    begin = source.rfind("\n", 0, start) + 1
    until = source.find("\n", end)
    until = len(source) if until < 0 else until
    return Mutant(
        file=file,
        function=function,
        start=start,
        end=end,
        new=new,
        line=" ".join(source[begin:until].split()),
        becomes=" ".join((source[begin:start] + new + source[end:until]).split()),
        number=source.count("\n", 0, begin) + 1,
    )


def _code(node: cst.CSTNode) -> str:
    return cst.Module([]).code_for_node(node)


def _by_mutmut(node: cst.CSTNode) -> Iterator[Mutated]:
    for kind, operator in mutators.mutation_operators:
        if isinstance(node, kind) and operator not in _LEFT_OUT:
            for mutated in operator(node):
                yield node, _code(mutated)


_LEFT_OUT: set[Callable[[Any], Any]] = {
    mutators.operator_number,  # ours are finer
    mutators.operator_string,  # likewise
    mutators.operator_assignment,  # ours drop the assignment
    mutators.operator_arg_removal,  # ours do not put None, which any call notices
    mutators.operator_lambda,
}


def _number(node: cst.CSTNode) -> Iterator[Mutated]:
    if isinstance(node, cst.Integer):
        value = node.evaluated_value
        if value > 1000:  # hardly a count: an edge between two numbers means nothing
            yield node, str(value + value // 4)
        else:
            yield node, str(value + 1)
            yield node, str(value - 1) if value else "(-1)"
    elif isinstance(node, cst.Float):
        yield node, repr(node.evaluated_value * 1.25 or 1.0)


def _string(node: cst.CSTNode) -> Iterator[Mutated]:
    if isinstance(node, cst.SimpleString) and " " not in node.value and "b" not in node.prefix:
        yield node, node.value[:-1] + "X" + node.value[-1] if len(node.quote) == 1 else node.value


def _name(node: cst.CSTNode) -> Iterator[Mutated]:
    if isinstance(node, cst.Attribute) and node.attr.value in _NAMES:
        yield node.attr, _NAMES[node.attr.value]
    elif isinstance(node, cst.Call) and isinstance(node.func, cst.Name) and node.func.value in _NAMES:
        yield node.func, _NAMES[node.func.value]


def _opposite(node: cst.CSTNode) -> Iterator[Mutated]:
    if isinstance(node, cst.ComparisonTarget):
        operator = _code(node.operator).strip()
        if operator in _OPPOSITES:
            yield node.operator, f" {_OPPOSITES[operator]} "
    test = node.test if isinstance(node, cst.If) else None  # mutmut has that of `a if b else c`
    if test is not None and not isinstance(test, cst.Comparison | cst.UnaryOperation):
        yield test, f"not ({_code(test)})"


def _dropped(node: cst.CSTNode) -> Iterator[Mutated]:
    """An operand, a result, an effect that is forgotten."""
    if isinstance(node, cst.BinaryOperation | cst.BooleanOperation):
        yield node, _code(node.left)
        if isinstance(node.operator, cst.And | cst.Or | cst.Multiply | cst.Add):
            yield node, _code(node.right)
    elif isinstance(node, cst.Return) and node.value is not None:
        if not m.matches(node.value, m.Name("None") | m.Name("False")):
            yield node, "return None"
    elif m.matches(node, _EFFECT):
        yield node, "pass"


_EFFECT = (
    m.Expr(value=m.Call())
    | m.AugAssign()
    | m.Assign(targets=[m.AssignTarget(m.Attribute() | m.Subscript())])
)


def _swapped(node: cst.CSTNode) -> Iterator[Mutated]:
    """Two neighbours in a tuple or list, if it is not one of types, whose order means nothing."""
    if isinstance(node, cst.Tuple | cst.List) and not _CLASSES.match(_code(node)):
        for i, (one, other) in enumerate(pairwise(node.elements)):
            if isinstance(one, cst.Element) and isinstance(other, cst.Element):
                pair = [one.with_changes(value=other.value), other.with_changes(value=one.value)]
                elements = [*node.elements[:i], *pair, *node.elements[i + 2 :]]
                yield node, _code(node.with_changes(elements=elements))


def _argument(node: cst.CSTNode) -> Iterator[Mutated]:
    """Two neighbouring arguments swapped, one left out."""
    if not isinstance(node, cst.Call) or _code(node.func) in _COMMUTATIVE:
        return
    arguments = [a for a in node.args if not a.star and _keyword(a) not in _UNMUTATED_ARGUMENTS]
    for one, other in pairwise(arguments):
        if bool(one.keyword) == bool(other.keyword):
            values = {id(one): other.value, id(other): one.value}
            swapped = [a.with_changes(value=values.get(id(a), a.value)) for a in node.args]
            yield node, _code(node.with_changes(args=swapped))
    for argument in arguments:
        # Another positional one has hardly a default: any call would notice.
        if len(node.args) > 1 and (argument.keyword or argument is node.args[-1]):
            *others, last = (a for a in node.args if a is not argument)
            left = [*others, last.with_changes(comma=cst.MaybeSentinel.DEFAULT)]
            yield node, _code(node.with_changes(args=left))


def _keyword(argument: cst.Arg) -> str:
    return argument.keyword.value if argument.keyword else ""


_OPERATORS = (_by_mutmut, _number, _string, _name, _opposite, _dropped, _swapped, _argument)


class _Finder(cst.CSTVisitor):
    """Walks a module; `found` holds function, start, end and replacement of each mutation."""

    METADATA_DEPENDENCIES = (ParentNodeProvider, WhitespaceInclusivePositionProvider)
    UNMUTATED: ClassVar = (
        *(cst.Annotation, cst.Decorator, cst.Import, cst.ImportFrom, cst.Raise, cst.Assert),
        *(cst.Del, cst.FormattedStringText),
    )

    def __init__(self, source: str) -> None:
        super().__init__()
        self._starts = [0, *(match.end() for match in re.finditer("\n", source))]
        self._source = source
        self._names: list[str] = []
        self.found: list[tuple[str, int, int, str]] = []

    def on_visit(self, node: cst.CSTNode) -> bool:
        """Mutates a node; tells whether what is in it is to be mutated."""
        if isinstance(node, self.UNMUTATED) or _is_words(node) or (not self._names and _is_typing(node)):
            return False
        candidates: dict[tuple[int, int], set[str]] = {}
        for operator in _OPERATORS:
            if operator is _swapped and self._is_looked_through(node):
                continue  # a membership has no order
            for target, new in operator(node):
                candidates.setdefault(self._span(target), set()).add(new)
        for (start, end), texts in candidates.items():
            old = self._source[start:end]
            line = self._source[self._source.rfind("\n", 0, start) + 1 : start].strip()
            ranks = {_hash(line, old, new): new for new in texts - {old}}
            chosen = [ranks[rank] for rank in sorted(ranks)[:A_PLACE]]
            self.found += [(".".join(self._names), start, end, new) for new in chosen]
        if isinstance(node, cst.FunctionDef | cst.ClassDef):
            self._names.append(node.name.value)
        return True

    def on_leave(self, original_node: cst.CSTNode) -> None:
        """Leaves a function or class."""
        if isinstance(original_node, cst.FunctionDef | cst.ClassDef) and self._names:
            self._names.pop()

    def _is_looked_through(self, node: cst.CSTNode) -> bool:
        parent = self.get_metadata(ParentNodeProvider, node, None)
        operator = parent.operator if isinstance(parent, cst.ComparisonTarget) else None
        return isinstance(operator, cst.In | cst.NotIn)

    def _span(self, node: cst.CSTNode) -> tuple[int, int]:
        place = self.get_metadata(WhitespaceInclusivePositionProvider, node)
        assert isinstance(place, CodeRange)  # noqa: S101 - for the type checker
        start, end = place.start, place.end
        return self._starts[start.line - 1] + start.column, self._starts[end.line - 1] + end.column


def _is_words(node: cst.CSTNode) -> bool:
    """Docstrings, what is logged, arguments that only people read, tests of `__name__`."""
    if isinstance(node, cst.Expr):
        return isinstance(node.value, cst.SimpleString | cst.ConcatenatedString) or _is_words(node.value)
    if isinstance(node, cst.Call):
        name = node.func.attr.value if isinstance(node.func, cst.Attribute) else _code(node.func)
        return name in _LOGGING | _TYPING
    if isinstance(node, cst.Arg):
        return _keyword(node) in _UNMUTATED_ARGUMENTS
    return isinstance(node, cst.If) and _code(node.test) in {"TYPE_CHECKING", '__name__ == "__main__"'}


def _is_typing(node: cst.CSTNode) -> bool:
    """Type aliases, which are named in CapWords, and names such as __all__."""
    target = node.targets[0].target if isinstance(node, cst.Assign) else None
    return isinstance(target, cst.Name) and bool(re.match(r"[A-Z]+[a-z]|__", target.value))
