"""What the data say of a threshold, as plain values: for scores file, parameter file and report."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from harness.tune.episodes.plan import Part
from harness.tune.scoring.estimate import FEWEST_DIGITS, MOST_DIGITS, Estimate, digits_for

Scores = Mapping[str, Estimate]  # by measure


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """One value of a threshold, a bool if it is a switch, with how it did by part of the plan.

    The part on which it was chosen flatters it.
    """

    value: float
    scores: Mapping[Part, Scores]


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What the data say of one threshold of one robot.

    Attributes:
        name: The ROS parameter; `unit` is its unit.
        measure: The one by which a value is chosen.
        default: RoboTerrain's value.
        tuned: What was chosen; None where the data support no value.
        gain: Tuned minus default on the test episodes, by measure.
        lack: Why the data support no value, in a clause; None if they do.
        note: What the tuned value holds for, or is made of; may be empty.
    """

    name: str
    unit: str
    measure: str
    default: Candidate
    tuned: Candidate | None = None
    gain: Scores = field(default_factory=dict)
    lack: str | None = None
    note: str = ""

    @property
    def value(self) -> float | None:
        """What a parameter file should say: None where the default stays.

        Only a value that beats the default on episodes on which it was not chosen is supported, by more
        than resampling both together explains, and by more than the digits that are shown hide.
        """
        if self.tuned is None:
            return None
        low = self.gain[self.measure].low
        return self.tuned.value if low is not None and round(low, MOST_DIGITS) > 0.0 else None

    @property
    def digits(self) -> int:
        """How many digits its scores need, so that tuned and default do not look the same."""
        return FEWEST_DIGITS if self.tuned is None else digits_for(self.gain[self.measure])

    def written(self, candidate: Candidate) -> str:
        """Returns a value with its unit."""
        value = candidate.value
        return str(value).lower() if isinstance(value, bool) else f"{value:g} {self.unit}"

    @property
    def is_proven(self) -> bool:
        """Whether the intervals of tuned and default on the test episodes do not overlap."""
        if self.tuned is None:
            return False
        tuned, default = (one.scores[Part.TEST][self.measure] for one in (self.tuned, self.default))
        return tuned.low is not None and default.high is not None and tuned.low > default.high
