"""`make mutants`: makes mutants of what was changed and tells those that no test notices."""

import argparse
import sys
import time
import zlib
from collections import Counter

from tools.mutants import survivors
from tools.mutants.journal import Outcome
from tools.mutants.mutant import Mutant
from tools.mutants.scope import ROOT, SOURCES, TESTS, Package, changed_since
from tools.mutants.survivors import LISTED, Key, Score
from tools.mutants.trial import Trial

KEPT = ROOT / "build/mutants"
TOLD = 5  # tests of a survivor


def main() -> int:
    """Returns 1 if a mutant survives that is not listed, or if the list is not true any more."""
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
    from tools.mutants.mutations import mutants_of  # noqa: PLC0415 - libcst takes long to load

    files = _files(options)
    known = {entry.key for entry in survivors.listed(LISTED)}
    every = {file: mutants_of(file, (ROOT / file).read_text()) for file in files}
    stale = {key for key in known if options.all or key[0] in every}
    stale -= {mutant.key for some in every.values() for mutant in some}
    made = {
        file: [
            m
            for m in some
            if _drawn(m, options.one_in, options.draw) and (m.key in known) == options.listed
        ]
        for file, some in every.items()
    }
    began = time.monotonic()
    outcomes = _outcomes(files, made, known)
    dead = {outcome.mutant.key for outcome in outcomes if outcome.killer} & known
    unlisted = [o.mutant for o in outcomes if not o.killer and o.mutant.key not in known]
    drawn = {
        file: [m for m in some if _drawn(m, options.one_in, options.draw)]
        for file, some in every.items()
    }
    scores = _scores(drawn, unlisted, known - dead)
    if options.listed:  # the others have been tried before, if it was the same sample
        before = survivors.recorded(survivors.SCORES)
        scores = {f: s for f, s in scores.items() if f in before and before[f].mutants == s.mutants}
    seconds = time.monotonic() - began
    print(survivors.table(scores, files), end="")
    survivors.record(scores)
    print(f"{seconds:.0f} s, {len(outcomes) / max(seconds, 1e-9):.1f} mutants/s")
    for told, keys in (("no such mutant any more", stale), ("a test notices it now", dead)):
        for key in sorted(keys):
            print(f"listed, but {told}:", *key, sep="\n    ")
    if options.list:
        survivors.update(LISTED, [mutant.key for mutant in unlisted], stale | dead)
    return 1 if unlisted or stale or dead else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="make mutants", description=__doc__)
    parser.add_argument("files", nargs="*", help="modules; if none is named, those that were changed")
    parser.add_argument("--all", action="store_true", help="the whole scope")
    parser.add_argument(
        "--one-in", type=int, default=1, metavar="N", help="a sample, the same for the same code"
    )
    parser.add_argument(
        "--draw", type=int, default=0, metavar="K", help="which of the N samples: 0 to N - 1; default: 0"
    )
    parser.add_argument("--base", metavar="REV", help="changed since when; default: since `main`")
    parser.add_argument("--list", action="store_true", help="bring survivors.toml up to date")
    parser.add_argument("--listed", action="store_true", help="try those that are listed, no other ones")
    options = parser.parse_args()
    if options.one_in < 1:
        parser.error(f"--one-in {options.one_in}: a sample is one in 1 or more")
    if not 0 <= options.draw < options.one_in:
        parser.error(f"--draw {options.draw}: the draws of --one-in are 0 to {options.one_in - 1}")
    return options


def _drawn(mutant: Mutant, one_in: int, draw: int) -> bool:
    """Whether a mutant is in a sample of one in so many; each is in exactly one draw."""
    return zlib.crc32("\0".join(mutant.key).encode()) % one_in == draw


def _files(options: argparse.Namespace) -> dict[str, Package]:
    """The modules to mutate and their packages."""
    scope = survivors.scope()
    if options.all:
        return scope
    if options.files:
        if missing := [file for file in options.files if not (ROOT / file).is_file()]:
            message = f"no such file: {', '.join(missing)}"
            raise ValueError(message)
        return {file: scope.get(file, survivors.ELSEWHERE) for file in options.files}
    changed = changed_since(options.base)
    return {file: package for file, package in scope.items() if file in changed}


def _outcomes(
    files: dict[str, Package], made: dict[str, list[Mutant]], known: set[Key]
) -> list[Outcome]:
    """Tries mutants; tells what survives and is not known."""
    groups: dict[tuple[bool, tuple[str, ...]], list[Mutant]] = {}
    for file, some in made.items():
        groups.setdefault((files[file].plain, files[file].tests or TESTS), []).extend(some)
    tell = _Teller(sum(map(len, groups.values())), known)
    print(f"{len(made)} modules, {tell.left} mutants to try", flush=True)
    outcomes = []
    for (plain, tests), mutants in groups.items():
        if mutants:
            found = Trial(ROOT, SOURCES, tests, plain, KEPT, tell).judge(mutants)
            if len(found) != len(mutants):
                message = f"{len(mutants) - len(found)} mutants were not tried"
                raise RuntimeError(message)
            outcomes += found
    return outcomes


def _scores(drawn: dict[str, list[Mutant]], unlisted: list[Mutant], known: set[Key]) -> dict[str, Score]:
    """Scores by file."""
    alive = Counter(mutant.file for mutant in unlisted)
    scores = {}
    for file, some in drawn.items():
        listed = sum(mutant.key in known for mutant in some)
        scores[file] = Score(len(some), len(some) - alive[file] - listed, listed)
    return scores


class _Teller:
    """Prints each unlisted survivor as it is found, and how many mutants are left."""

    def __init__(self, left: int, known: set[Key]) -> None:
        self.left, self._known = left, known
        self._out = sys.stdout  # where a session of pytest has none

    def __call__(self, outcome: Outcome) -> None:
        self.left -= 1
        mutant, tests = outcome.mutant, outcome.tests
        if not outcome.killer and mutant.key not in self._known:
            more = f" and {len(tests) - TOLD} more" if len(tests) > TOLD else ""
            self._print(f"{mutant.file}:{mutant.number}: {mutant.line}  ->  {mutant.becomes}")
            self._print(f"    {', '.join(tests[:TOLD]) or 'no test runs this'}{more}")
        if self.left % 100 == 0:
            self._print(f"{self.left} left")

    def _print(self, line: str) -> None:
        print(line, file=self._out, flush=True)


if __name__ == "__main__":
    sys.exit(main())
