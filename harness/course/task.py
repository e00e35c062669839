"""What an episode of a track asks: a run, where to go in it, and how that is scored."""

from dataclasses import dataclass

from harness.spec.run import Run

Point = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Rule:
    """How a track is judged.

    Attributes:
        limit: Time for all goals [s].
        fastest: Multiple of the optimal time from which on a success scores less.
        slowest: Multiple beyond which it scores no less.
        begins_at: Distance from the start at which the clock starts [m].
        touch_ends: Whether a contact with a hazard ends the episode, without success.
        penalties: Whether contact, scraping and energy take from the score.
    """

    limit: float = 60.0
    fastest: float = 1.0
    slowest: float = 4.0
    begins_at: float = 0.0
    touch_ends: bool = False
    penalties: bool = True


@dataclass(frozen=True, kw_only=True)
class Task:
    """One episode of a track.

    Attributes:
        run: The world and the rover, which obeys commands, and the route that is to be driven.
        shortest: Length of the shortest way through all goals [m].
        speed: At which that can be driven at best [m/s].
        rule: How it is judged.
    """

    run: Run
    shortest: float
    speed: float
    rule: Rule

    @property
    def optimal(self) -> float:
        """Time that the shortest way takes at best [s]."""
        return self.shortest / self.speed


@dataclass(frozen=True)
class WorldFile:
    """A file that a task needs, by value, so that a worker on another machine has it too.

    Attributes:
        name: Of the file, without a folder.
        text: Its content.
        length: Of the shortest way that is published for it [m]; None if none is.
    """

    name: str
    text: bytes
    length: float | None = None


@dataclass(frozen=True)
class Case:
    """What identifies an episode: its track, its seed and, where the world is a file, that file."""

    track: str
    seed: int
    world: WorldFile | None = None

    @property
    def name(self) -> str:
        """What the episode is called in messages."""
        return f"{self.track} {self.seed}" + (f" ({self.world.name})" if self.world else "")
