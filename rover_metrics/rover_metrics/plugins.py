"""Tables that others can add to, without a fork: what ships, installed plug-ins, and FILE.py:NAME.

An installed package adds to a table by an entry point of the group rover_harness.TABLE; a file's value
is named where a name of the table is, e.g. `--terrain moon.py:Moon`. docs/extend.md has the contract of
each table.
"""

import gc
import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from pkgutil import resolve_name
from traceback import extract_tb
from types import FunctionType, ModuleType
from typing import Any, Generic, TypeVar

from rover_metrics.errors import BLAMES, RoverMetricsError, printable, shown

GROUP = "rover_harness."
KINDS = (  # the tables there are
    *("terrains", "soils", "drivers", "sensors", "faults", "columns"),
    *("expectations", "rewards", "endings", "observations"),
)
FILE = ".py:"  # in the name of a value in a file
MODULE = "rover_plugin_"  # begins the name of a file's module
T = TypeVar("T")


class PluginError(RoverMetricsError):
    """A plug-in that cannot be loaded, or is not what its table holds; the message names it."""


class MisfitError(TypeError):
    """A plug-in that has given what its table's contract does not allow; the message names both."""


def misfit(part: object, given: object, wanted: str) -> MisfitError:
    """Returns the error of a plug-in that gives what it must not.

    Args:
        part: The plug-in: a class, a function or an instance.
        given: By it.
        wanted: What it should have given.
    """
    kind: Any = part if hasattr(part, "__qualname__") else type(part)
    file = getattr(sys.modules.get(kind.__module__), "__file__", kind.__module__)
    return MisfitError(
        printable(f"{file}: {kind.__qualname__} gives {shown(repr(given))}, not {wanted}")
    )


class Shipped(Mapping[str, T], Generic[T]):
    """Values of this project by name, each in a module that is loaded when the value is asked for.

    Args:
        package: That holds the modules.
        places: .MODULE:VALUE by name, below the package; :VALUE of the package itself.
    """

    def __init__(self, package: str, places: Mapping[str, str]) -> None:
        self._package, self.places = package, places

    def __getitem__(self, name: str) -> T:
        value: T = resolve_name(self._package + self.places[name])
        return value

    def __contains__(self, name: object) -> bool:
        return name in self.places

    def __iter__(self) -> Iterator[str]:
        return iter(self.places)

    def __len__(self) -> int:
        return len(self.places)


class Table(Mapping[str, T], Generic[T]):
    """Values by name; those that ship come first, the others are loaded when they are asked for.

    Args:
        name: Of the table, e.g. "terrains": its entry points are those of rover_harness.terrains.
        shipped: The values of this project.
        fits: Whether a value of somebody else is one of the kind.
        form: What it must be, for the message.

    Attributes:
        name, shipped, fits, form: As given.

    Raises:
        PluginError: Of a look-up: the plug-in of that name cannot be used.
    """

    def __init__(
        self, name: str, shipped: Mapping[str, T], fits: Callable[[Any], bool], form: str
    ) -> None:
        self.name, self.shipped = name, shipped
        self.fits, self.form = fits, form
        self._loaded: dict[str, T] = {}

    def __getitem__(self, name: str) -> T:
        if name in self.shipped:
            return self.shipped[name]
        if name not in self._loaded:
            self._loaded[name] = self._load(name)
        return self._loaded[name]

    def __iter__(self) -> Iterator[str]:
        yield from self.shipped
        yield from (name for name in sorted(_installed(self.name)) if name not in self.shipped)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def loaded(self) -> Mapping[str, T]:
        """Returns the plug-ins that have been asked for, by name."""
        return self._loaded

    def source(self, name: str) -> tuple[str, str] | None:
        """Returns where a plug-in comes from and the SHA-256 of its file; None for what ships."""
        if name in self.shipped:
            return None
        point = _installed(self.name).get(name)
        if point is None:
            return name.rpartition(":")[0], _hash(Path(name.rpartition(":")[0]))
        file = getattr(sys.modules.get(point.module), "__file__", None)
        return _package(point), _hash(Path(file)) if file else ""

    def _load(self, name: str) -> T:
        point = _installed(self.name).get(name)
        if point is None and FILE not in name:
            raise KeyError(name)
        where = f"{self.name}: '{name}'" + ("" if point is None else f" of {_package(point)}")
        try:
            value = _in_file(name) if point is None else point.load()
        except (Exception, SystemExit) as error:  # whatever a plug-in raises
            reason = printable(f"{type(error).__name__}: {error}")
            raise PluginError(f"{where} cannot be loaded: {reason}") from error
        with suppress(Exception):  # whatever `fits` meets in it
            if self.fits(value):
                fitting: T = value
                return fitting
        raise PluginError(f"{where} is not {self.form} (docs/extend.md)")


def blamed(error: BaseException) -> str:
    """Returns the last line of a plug-in that led to an error, and the error; "" if none did.

    A function of a plug-in that takes other arguments than it is given leads to an error, too.
    """
    if isinstance(error, MisfitError):
        return str(error)
    modules = tuple(f"{point.module}." for kind in KINDS for point in _installed(kind).values())
    files = {
        getattr(module, "__file__", None): module
        for name, module in [*sys.modules.items()]
        if name.startswith(MODULE) or f"{name}.".startswith(modules)
    }
    frames = [frame for frame in extract_tb(error.__traceback__) if frame.filename in files]
    if not frames and isinstance(error, TypeError) and "() " in str(error) and files:
        called = str(error).partition("() ")[0]  # "Mine.command() takes 1 positional argument but ..."
        makers = {each.__module__ for each in _made(called)}
        theirs = [file for file, module in files.items() if module.__name__ in makers]
        return printable(f"{theirs[-1]}: {error}; docs/extend.md has what it is given") if theirs else ""
    if not frames:
        return ""
    place = f"{frames[-1].filename}, line {frames[-1].lineno}, in {frames[-1].name}"
    return printable(f"{place}: {frames[-1].line}: {type(error).__name__}: {error}")


def _made(name: str) -> Iterator[Any]:
    """Yields the functions and classes of that name, also those that no module has by it."""
    gc.unfreeze()  # what was loaded before a run is out of the collector's sight
    for each in gc.get_objects():
        if issubclass(type(each), FunctionType | type) and each.__qualname__ == name:
            yield each


BLAMES.append(blamed)


def takes(function: object, count: int) -> bool:
    """Returns whether something can be called with so many arguments by position, as far as it says."""
    try:
        inspect.signature(function).bind(*range(count))  # type: ignore[arg-type]
    except TypeError:  # it cannot, or is no function
        return False
    except ValueError:  # compiled code that does not say
        return True
    return True


def installed(tables: Iterable[Table[Any]]) -> Iterator[str]:
    """Yields a line for each plug-in of the installed packages: what it is, or why it cannot be used.

    Args:
        tables: Those that are loaded; plug-ins of others are only loaded, not checked.
    """
    known = {table.name: table for table in tables}
    for kind in KINDS:
        table = known.get(kind) or Table[Any](kind, {}, lambda _: True, "")
        points = _all_installed().select(group=GROUP + kind)
        yield from (_line(table, one.name, one) for one in sorted(points, key=_called))
    for group in sorted(_all_installed().groups - {GROUP + kind for kind in KINDS}):
        if group.startswith(GROUP):
            names = ", ".join(sorted(map(_called, _all_installed().select(group=group))))
            yield f"{group} is no table, so nothing has {names}; tables: {', '.join(KINDS)}"


def _line(table: Table[Any], name: str, point: EntryPoint) -> str:
    used = _installed(table.name)[name]
    if name in table.shipped or used is not point:
        other = "of ours" if name in table.shipped else f"of {_package(used)}"
        return f"{table.name}: {_called(point)} is not used, as one {other} has that name; rename it"
    try:
        value = table[name]
    except PluginError as error:
        return str(error)
    about = getattr(value, "summary", "") or getattr(value, "meaning", "")
    about = about or (value.__doc__ or "").partition(".")[0]
    return f"{table.name}: {', '.join(filter(None, (name, about)))} ({_package(point)})"


@cache
def _installed(table: str) -> dict[str, EntryPoint]:
    """The entry points of a table, by name."""
    return {point.name: point for point in _all_installed().select(group=GROUP + table)}


# Every installed package is looked through for them: 8 ms.
_all_installed = cache(entry_points)


def _package(point: EntryPoint) -> str:
    return f"{point.dist.name} {point.dist.version}" if point.dist else point.module


def _called(point: EntryPoint) -> str:
    return f"'{point.name}' of {_package(point)}"


def _in_file(name: str) -> Any:  # noqa: ANN401 - whatever the file has there
    path, _, wanted = name.rpartition(":")
    module = _module(Path(path).resolve())
    if wanted in vars(module):
        return vars(module)[wanted]
    raise LookupError(f"no {wanted or 'name'} there; it has {', '.join(_own(module)) or 'nothing'}")


def _own(module: ModuleType) -> list[str]:
    """Names of what a module makes itself: its classes and functions, and values, but no modules."""
    return [
        name
        for name, value in vars(module).items()
        if not (name.startswith("_") or isinstance(value, ModuleType))
        and (not hasattr(value, "__qualname__") or value.__module__ == module.__name__)
    ]


@cache
def _module(path: Path) -> ModuleType:
    """The module of a file; under the same name in every process, so that its values can be sent."""
    name = f"{MODULE}{path.stem}_{hashlib.sha256(str(path).encode()).hexdigest()[:8]}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None or not path.is_file():
        raise FileNotFoundError(f"there is no file {path}")
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
