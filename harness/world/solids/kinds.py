"""Rock or hazard: what a solid is by its height above the ground, or by its name."""

from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase

from harness.base.errors import UsageError, unknown
from harness.spec.world import WorldSpec
from harness.world.obstacles import ObstacleKind

Kind = Callable[[float], ObstacleKind]  # of what is that high above the ground [m]


class Kinds:
    """The rule of one world; a pattern that fits no solid is a UsageError.

    Args:
        spec: With the height and the names that override the rover's clearance.
        clearance: Height of obstacles that the rover drives over [m].
        names: Of all solids: model::link::collision.

    Attributes:
        limit: Height above the ground up to which an obstacle is a rock [m].
    """

    def __init__(self, spec: WorldSpec, clearance: float, names: Sequence[str]) -> None:
        self.clearance = clearance
        self.limit = clearance if spec.rock_height is None else spec.rock_height
        self._named = {ObstacleKind.HAZARD: spec.hazard, ObstacleKind.ROCK: spec.rock}
        models = dict.fromkeys(name.split("::")[0] for name in names)
        for flag, patterns in (("--hazard", spec.hazard), ("--rock", spec.rock)):
            for pattern in patterns:
                if not any(_fits(name, pattern) for name in names):
                    raise UsageError(f"{flag}: {unknown('solid', pattern, [*models][:12])}")

    def by_height(self, height: float) -> ObstacleKind:
        """Returns the kind of an obstacle by its height above the ground [m]."""
        return ObstacleKind.ROCK if height <= self.limit else ObstacleKind.HAZARD

    def of(self, name: str) -> Kind:
        """Returns the rule for a solid of that name."""
        for kind, patterns in self._named.items():
            if any(_fits(name, pattern) for pattern in patterns):
                return lambda _, kind=kind: kind  # type: ignore[misc]  # bound now
        return self.by_height


def _fits(name: str, pattern: str) -> bool:
    """Whether a pattern fits the whole name, or that of the model."""
    return fnmatchcase(name, pattern) or fnmatchcase(name.split("::", maxsplit=1)[0], pattern)
