"""Files and folders of scenarios to the runs that are asked for."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from harness.base.errors import UsageError
from harness.scenario.case import Case, cases_of
from harness.scenario.reading import SUFFIX, read_scenario

Selected = tuple[tuple[str, str], ...]  # names and values of the matrix


def find_files(paths: Iterable[Path]) -> list[Path]:
    """Returns the scenario files that are named, and those below folders that are, in order.

    Raises:
        UsageError: There is no such file, or a folder without one.
    """
    found: dict[Path, None] = {}
    for path in paths:
        if path.is_dir():
            below = sorted(path.rglob(f"*{SUFFIX}"))
            if not below:
                raise UsageError(f"there is no *{SUFFIX} below {path}")
            found |= dict.fromkeys(below)
        elif path.is_file():
            found[path] = None
        else:
            raise UsageError(f"there is no scenario {path}; name a *{SUFFIX}, or a folder of them")
    return list(found)


def plan(files: Iterable[Path], seeds: Sequence[int] | None = None, only: Selected = ()) -> list[Case]:
    """Returns all runs of some files, checked.

    Args:
        files: The scenarios.
        seeds: Instead of theirs.
        only: Values of the matrix; other runs are left out.

    Raises:
        UsageError: A file is not valid, or nothing is left.
    """
    cases = [case for path in files for case in cases_of(path, read_scenario(path), seeds)]
    wanted = set(only)
    left = [case for case in cases if wanted <= {(name, str(value)) for name, value in case.cell}]
    if not left:
        raise UsageError(f"no run has {', '.join('='.join(pair) for pair in only)}")
    return left
