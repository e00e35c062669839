"""What became of mutants, kept as it is found: a run that ends early is taken up where it was."""

import json
from dataclasses import dataclass
from pathlib import Path

from tools.mutants.mutant import Mutant


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant.

    Attributes:
        mutant: The mutant.
        killer: The test that failed, or how the process ended; empty if it survived.
        tests: The tests that were to notice it.
    """

    mutant: Mutant
    killer: str
    tests: tuple[str, ...]


@dataclass(frozen=True)
class Journal:
    """A file with a line for each outcome.

    Attributes:
        path: The file; it need not exist.
    """

    path: Path

    def write(self, outcome: Outcome) -> None:
        """Adds an outcome; it counts instead of an earlier one of the same mutant."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a") as file:
            file.write(json.dumps([_place(outcome.mutant), outcome.killer, outcome.tests]) + "\n")

    def outcomes(self, mutants: list[Mutant]) -> list[Outcome]:
        """Returns what is known of some mutants, in their order."""
        if not self.path.exists():
            return []
        lines = [json.loads(line) for line in self.path.read_text().splitlines()]
        known = {tuple(place): (killer, tuple(tests)) for place, killer, tests in lines}
        return [Outcome(m, *known[_place(m)]) for m in mutants if _place(m) in known]


def _place(mutant: Mutant) -> tuple[object, ...]:
    return mutant.file, mutant.start, mutant.end, mutant.new
