"""What a quantity must keep: limits, or a tolerance about its baseline, over a window of the run."""

import re
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, StringConstraints, model_validator

from harness.scenario.names import FULL_NAME
from harness.spec.value import Finite, NotNegative, Seconds, Value, as_tuple

Over = Literal["always", "end", "mean", "p95", "share"]
Share = Annotated[float, Field(gt=0.0, le=1.0)]  # of runs or values that must be as expected
Text = Annotated[str, StringConstraints(min_length=1, strip_whitespace=True)]
Point = tuple[Finite, Finite]


def _full(name: str) -> str:
    if re.fullmatch(FULL_NAME, name) is None:
        raise ValueError(f"'{name}' is no full name of a topic or a node; give one such as /scan")
    return name


FullName = Annotated[str, AfterValidator(_full), Field(json_schema_extra={"pattern": f"^{FULL_NAME}$"})]

OF_ONE_VALUE = ("end", "mean", "p95")  # what a baseline can hold


class Bound(Value):
    """What a quantity must keep.

    Attributes:
        min: Smallest allowed value; no limit if left out.
        max: Largest allowed value; no limit if left out.
        over: What is compared: every value, the last one, the mean, the 95th percentile, or the share
            of values between min and max.
        share: With `over: share`, the smallest allowed share of values.
        window: First and last second that count; the whole run if left out.
        relative: Largest distance from the recorded baseline, as a share of it. `absolute` is the same
            in the unit of the quantity; with both, the larger one counts.
        of: The topic of the input, of the latency of a topic.
    """

    min: Finite | None = None
    max: Finite | None = None
    over: Over = "always"
    share: Share | None = None
    window: Annotated[tuple[Seconds, Seconds], BeforeValidator(as_tuple)] | None = None
    relative: NotNegative | None = None
    absolute: NotNegative | None = None
    of: FullName | None = None

    def label(self, name: str) -> str:
        """Returns what a quantity of that name is called in messages."""
        return name if self.of is None else f"{name} of {self.of}"

    @property
    def limits(self) -> str:
        """What is allowed, in a few words, e.g. ">= 0, <= 25, mean, 5 to 10 s"."""
        words = [
            "" if self.min is None else f">= {self.min:g}",
            "" if self.max is None else f"<= {self.max:g}",
            "near its baseline" if self.has_baseline else "",
            "" if self.over in ("always", "share") else self.over,
            "" if self.share is None else f"of {self.share:.0%} of values",
            "" if self.window is None else f"{self.window[0]:g} to {self.window[1]:g} s",
        ]
        return ", ".join(filter(None, words))

    @property
    def has_baseline(self) -> bool:
        """Whether it is kept near a recorded value, not within given limits."""
        return self.relative is not None or self.absolute is not None

    def tolerance(self, baseline: float) -> float:
        """Returns the largest allowed distance from a baseline."""
        return max((self.relative or 0.0) * abs(baseline), self.absolute or 0.0)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.has_baseline:
            self._check_baseline()
        elif self.min is None and self.max is None:
            raise ValueError(
                "nothing is expected; give min, max, or relative or absolute (to the baseline)"
            )
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min {self.min:g} is above max {self.max:g}: no value can be right")
        if (self.over == "share") != (self.share is not None):
            raise ValueError("'over: share' and 'share: 0 to 1' belong together")
        if self.window is not None and not self.window[0] < self.window[1]:
            raise ValueError(f"window {list(self.window)} does not begin before it ends")
        return self

    def _check_baseline(self) -> None:
        if self.min is not None or self.max is not None:
            raise ValueError(
                "limits and a tolerance about the baseline are two bounds; give a list of them"
            )
        if self.over not in OF_ONE_VALUE:
            raise ValueError(f"a baseline holds one value; give over: {', '.join(OF_ONE_VALUE)}")


class Measure(Bound):
    """What is measured of a quantity without a limit; of `always` it is the highest value."""

    over: Over = "mean"

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        limits = {"min", "max", "relative", "absolute", "share"} & self.model_fields_set
        if limits or self.over == "share":
            raise ValueError("what is measured has no limits; what shall keep some belongs to 'expect'")
        if self.window is not None and not self.window[0] < self.window[1]:
            raise ValueError(f"window {list(self.window)} does not begin before it ends")
        return self
