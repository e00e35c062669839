"""How many mutants died, by room, and what that must reach."""

from collections import Counter
from collections.abc import Iterable

from tools.mutants.journal import Outcome
from tools.mutants.scope import room_of

THRESHOLD = 90.0  # [%] of the mutants of a room
FEWEST = 10  # mutants of a room, for a score to be judged


def by_room(outcomes: Iterable[Outcome]) -> dict[str, tuple[int, int]]:
    """Returns how many mutants of each room there were, and how many of these died."""
    made: Counter[str] = Counter()
    died: Counter[str] = Counter()
    for outcome in outcomes:
        name = room_of(outcome.mutant.file).name
        made[name] += 1
        died[name] += bool(outcome.killer)
    return {name: (made[name], died[name]) for name in sorted(made)}


def table(scores: dict[str, tuple[int, int]]) -> str:
    """Returns the scores as a table in Markdown."""
    rows = (
        f"| {name} | {n} | {died} | {100 * died / n:.1f} % |\n" for name, (n, died) in scores.items()
    )
    return "| room | mutants | killed | share |\n|---|---|---|---|\n" + "".join(rows)


def below(scores: dict[str, tuple[int, int]]) -> list[str]:
    """Returns the rooms whose tests notice too little."""
    judged = {name: score for name, score in scores.items() if score[0] >= FEWEST}
    return [name for name, (made, died) in judged.items() if 100 * died / made < THRESHOLD]
