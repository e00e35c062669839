"""Mutants in the place of what they are made of: in functions that exist, or at import."""

import gc
import importlib.util
from collections import defaultdict
from collections.abc import Iterator, Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, FunctionType, ModuleType

from tools.mutants.mutant import Mutant

Functions = dict[tuple[str, str, int], list[FunctionType]]


def functions_of(files: set[str]) -> Functions:
    """All functions that there are of some files, by what their code says of itself."""
    found: Functions = defaultdict(list)
    for function in gc.get_objects():
        if type(function) is FunctionType and function.__code__.co_filename in files:
            found[_place(function.__code__)].append(function)
    return found


def _place(code: CodeType) -> tuple[str, str, int]:
    return code.co_filename, code.co_qualname, code.co_firstlineno


def swap(path: str, mutant: Mutant, functions: Functions) -> bool:
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


def _changed(
    old: CodeType, new: CodeType, *, within: bool = False
) -> Iterator[tuple[CodeType, CodeType, bool]]:
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


class Importer(MetaPathFinder):
    """Gives a mutant for its module."""

    def __init__(self, root: Path, mutant: Mutant) -> None:
        self._path, self._mutant = root / mutant.file, mutant

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
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
            name,
            self._path,
            loader=Loader(name, str(self._path)),
            submodule_search_locations=spec.submodule_search_locations,
        )
