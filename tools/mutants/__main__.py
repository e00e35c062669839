"""`make mutants`: makes mutants of what was changed and tells those that no test notices."""

import argparse
import sys
import time
from collections import Counter

from tools.mutants import survivors
from tools.mutants.mutations import Mutant, mutants_of
from tools.mutants.scope import PACKAGES, ROOT, SOURCES, TESTS, Package, changed_since, modules_of
from tools.mutants.survivors import Score
from tools.mutants.trial import Outcome, Trial

ELSEWHERE = Package("elsewhere", ())
TOLD = 5  # tests of a survivor


def main() -> int:
    """Returns 1 if a mutant survives that is not listed, or if the list is stale."""
    options = _options()
    try:
        files = _files(options)
    except ValueError as error:
        sys.stderr.write(f"mutants: {error}\n")
        return 2
    entries = survivors.listed()
    known = {entry.key for entry in entries}
    made = {file: mutants_of(file, (ROOT / file).read_text()) for file in files}
    stale = known - {m.key for some in made.values() for m in some} if options.all else set[survivors.Key]()
    stale |= {e.key for e in entries if e.key[0] in made} - {m.key for some in made.values() for m in some}
    groups: dict[tuple[bool, tuple[str, ...]], list[Mutant]] = {}
    for file, some in made.items():
        group = groups.setdefault((files[file].plain, files[file].tests or TESTS), [])
        group += [mutant for mutant in some if options.relist or mutant.key not in known]
    began = time.monotonic()
    tell = _Teller(sum(len(group) for group in groups.values()), known)
    print(f"{sum(map(len, made.values()))} mutants of {len(made)} modules, {tell.left} to try", flush=True)
    outcomes = []
    try:
        for (plain, tests), mutants in groups.items():
            if mutants:
                outcomes += Trial(ROOT, SOURCES, tests, plain, tell).judge(mutants)
    except KeyboardInterrupt:
        print("mutants: interrupted")
        return 130
    except RuntimeError as error:
        print(f"mutants: {error}")
        return 2
    dead = {outcome.mutant.key for outcome in outcomes if outcome.killer}
    unlisted = [o.mutant for o in outcomes if not o.killer and o.mutant.key not in known]
    scores = _scores(files, made, unlisted, known - dead)
    print(survivors.table(scores), end="")
    print(f"{time.monotonic() - began:.0f} s, {len(outcomes) / (time.monotonic() - began):.1f} mutants/s")
    for key in sorted(stale):
        print("STALE, no such mutant any more:", *key, sep="\n    ")
    for key in sorted(known & dead):
        print("LISTED, but a test notices it now:", *key, sep="\n    ")
    if options.list:
        survivors.append(unlisted)
    if options.all:
        survivors.record(scores)
    return 1 if unlisted or stale or known & dead else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="make mutants", description=__doc__)
    parser.add_argument("files", nargs="*", help="modules; those changed since the base if none is named")
    parser.add_argument("--all", action="store_true", help="the whole scope; keeps the scores")
    parser.add_argument("--base", metavar="REV", help="what is changed since this; default: since `main`")
    parser.add_argument("--list", action="store_true", help="add survivors to survivors.toml; give reasons there")
    parser.add_argument("--relist", action="store_true", help="try those that are listed as well")
    return parser.parse_args()


def _files(options: argparse.Namespace) -> dict[str, Package]:
    """The modules to mutate and their packages."""
    scope = {file: package for package in PACKAGES for file in modules_of(package)}
    if options.all:
        return scope
    if options.files:
        if missing := [file for file in options.files if not (ROOT / file).is_file()]:
            raise ValueError(f"no such file: {', '.join(missing)}")
        return {file: scope.get(file, ELSEWHERE) for file in options.files}
    changed = changed_since(options.base)
    return {file: package for file, package in scope.items() if file in changed}


def _scores(
    files: dict[str, Package], made: dict[str, list[Mutant]], unlisted: list[Mutant], known: set[survivors.Key]
) -> dict[str, Score]:
    """Scores by package, in the order of the scope."""
    mutants, alive, listed = Counter[str](), Counter[str](), Counter[str]()
    for file, some in made.items():
        mutants[files[file].name] += len(some)
        listed[files[file].name] += sum(mutant.key in known for mutant in some)
    for mutant in unlisted:
        alive[files[mutant.file].name] += 1
    names = [package.name for package in (*PACKAGES, ELSEWHERE) if mutants[package.name]]
    return {n: Score(mutants[n], mutants[n] - alive[n] - listed[n], listed[n]) for n in names}


class _Teller:
    """Prints each unlisted survivor as it is found, and how many mutants are left."""

    def __init__(self, left: int, known: set[survivors.Key]) -> None:
        self.left, self._known = left, known

    def __call__(self, outcome: Outcome) -> None:
        self.left -= 1
        mutant = outcome.mutant
        if not outcome.killer and mutant.key not in self._known:
            more = f" and {len(outcome.tests) - TOLD} more" if len(outcome.tests) > TOLD else ""
            print(f"{mutant.file}:{mutant.number}: {mutant.line}  ->  {mutant.becomes}")
            print(f"    {', '.join(outcome.tests[:TOLD]) or 'no test runs this'}{more}", flush=True)
        if self.left % 100 == 0:
            print(f"{self.left} left", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
