"""`make mutants`: makes mutants of what was changed and prints those that no test notices."""

import argparse
import sys
import time
import zlib

from tools.mutants import scores
from tools.mutants.journal import Outcome
from tools.mutants.mutant import Mutant
from tools.mutants.scope import ROOT, SOURCES, Room, changed_since, modules, room_of
from tools.mutants.trial import Trial

KEPT = ROOT / "build/mutants"
SHOWN = 5  # tests of a survivor


def main() -> int:
    """Returns 1 if the tests of a room notice less than THRESHOLD of its mutants."""
    options = _options()
    try:
        return _run(options)
    except KeyboardInterrupt:
        print("mutants: interrupted")
        return 130
    except (ValueError, RuntimeError) as error:
        print(f"mutants: {error}")
        return 2


def _run(options: argparse.Namespace) -> int:
    from tools.mutants.mutations import mutants_of

    made = [
        mutant
        for file in _files(options)
        for mutant in mutants_of(file, (ROOT / file).read_text())
        if _drawn(mutant, options.one_in, options.draw)
    ]
    began = time.monotonic()
    outcomes = _outcomes(made)
    seconds = time.monotonic() - began
    found = scores.by_room(outcomes)
    print(scores.table(found), end="")
    print(f"{seconds:.0f} s, {len(outcomes) / max(seconds, 1e-9):.1f} mutants/s")
    low = scores.below(found)
    for name in low:
        print(f"mutants: {name}: fewer than {scores.THRESHOLD:g} % were noticed")
    return 1 if low else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="make mutants", description=__doc__)
    parser.add_argument("files", nargs="*", help="modules; if none is named, those that were changed")
    parser.add_argument("--all", action="store_true", help="every module")
    parser.add_argument(
        "--one-in", type=int, default=1, metavar="N", help="a sample, the same for the same code"
    )
    parser.add_argument(
        "--draw", type=int, default=0, metavar="K", help="which of the N samples: 0 to N - 1; default: 0"
    )
    parser.add_argument("--base", metavar="REV", help="changed since when; default: since `main`")
    options = parser.parse_args()
    if options.one_in < 1:
        parser.error(f"--one-in {options.one_in}: a sample is one in 1 or more")
    if not 0 <= options.draw < options.one_in:
        parser.error(f"--draw {options.draw}: the draws of --one-in are 0 to {options.one_in - 1}")
    return options


def _drawn(mutant: Mutant, one_in: int, draw: int) -> bool:
    """Whether a mutant is in a sample of one in so many; each is in exactly one draw."""
    return zlib.crc32("\0".join(mutant.key).encode()) % one_in == draw


def _files(options: argparse.Namespace) -> list[str]:
    """The modules to mutate."""
    if options.all:
        return modules()
    if missing := [file for file in options.files if not (ROOT / file).is_file()]:
        message = f"no such file: {', '.join(missing)}"
        raise ValueError(message)
    changed = set() if options.files else changed_since(options.base)
    return options.files or [file for file in modules() if file in changed]


def _outcomes(made: list[Mutant]) -> list[Outcome]:
    """Tries mutants; prints what survives."""
    groups: dict[Room, list[Mutant]] = {}
    for mutant in made:
        groups.setdefault(room_of(mutant.file), []).append(mutant)
    report = Reporter(len(made))
    print(f"{len(groups)} rooms, {len(made)} mutants to try", flush=True)
    outcomes = []
    for room, mutants in groups.items():
        tried = Trial(ROOT, SOURCES, room.tests, room.plain, KEPT, report).judge(mutants)
        if len(tried) != len(mutants):
            message = f"{len(mutants) - len(tried)} mutants were not tried"
            raise RuntimeError(message)
        outcomes += tried
    return outcomes


class Reporter:
    """Prints each survivor as it is found, and how many mutants are left.

    Args:
        left: How many there are.
    """

    def __init__(self, left: int) -> None:
        self._left = left
        self._out = sys.stdout  # where a session of pytest has none

    def __call__(self, outcome: Outcome) -> None:
        """Takes what became of the next mutant."""
        self._left -= 1
        mutant, tests = outcome.mutant, outcome.tests
        if not outcome.killer:
            more = f" and {len(tests) - SHOWN} more" if len(tests) > SHOWN else ""
            self._print(f"{mutant.file}:{mutant.number}: {mutant.line}  ->  {mutant.becomes}")
            self._print(f"    {', '.join(tests[:SHOWN]) or 'no test runs this'}{more}")
        if self._left % 100 == 0:
            self._print(f"{self._left} left")

    def _print(self, line: str) -> None:
        print(line, file=self._out, flush=True)


if __name__ == "__main__":
    sys.exit(main())
