"""A fault as a user writes it: SENSOR:FAULT[=VALUE][@START[+LENGTH]], e.g. imu:nan@10+2.

START and LENGTH are simulated seconds. Without a LENGTH a fault lasts to the end, without a START it
lasts the whole run. Which sensors and faults exist is known to harness.faults.
"""

import math
import re
from dataclasses import dataclass
from typing import Annotated

from harness.base.errors import UsageError
from harness.spec.value import AsText, parsed
from rover_metrics.number import number

FORM = "SENSOR:FAULT[=VALUE][@START[+LENGTH]]"
LONGEST = 1e8  # [s]: stamps have 31 bits of seconds
_SPEC = re.compile(
    r"(?P<sensor>[^:=@+]+):(?P<kind>(?:[^=@]+\.py:)?[^:=@+]+)(?:=(?P<value>[^@]+))?"
    r"(?:@(?P<start>[^+]+)(?:\+(?P<length>.+))?)?"
)


@dataclass(frozen=True)
class FaultSpec:
    """A fault of a sensor or of the clock, by their names, and when it acts.

    Attributes:
        text: As it was written.
        value: What stands behind the "="; None if nothing does.
        start: When it begins [s]; None for the whole run.
        length: How long it lasts [s]; None to the end.
    """

    text: str
    sensor: str
    kind: str
    value: float | None = None
    start: float | None = None
    length: float | None = None

    def __str__(self) -> str:
        """Returns the text that it was read from."""
        return self.text


def parse_fault(text: str) -> FaultSpec:
    """Returns the fault that a text stands for; UsageError if it is not of that form."""
    match = _SPEC.fullmatch(text)
    if match is None:
        raise UsageError(f"fault '{text}' is not of the form {FORM}, e.g. imu:nan@10+2")
    try:
        value = None if match["value"] is None else number(match["value"])
    except ValueError as error:
        message = f"fault '{text}': value '{match['value']}' is not valid; give a number"
        raise UsageError(message) from error
    start, length = (_seconds(text, match[name], name.upper()) for name in ("start", "length"))
    if length == 0.0:
        raise UsageError(f"fault '{text}': LENGTH is 0 s; give more, or leave it out")
    return FaultSpec(text, match["sensor"], match["kind"], value, start, length)


def _seconds(text: str, word: str | None, name: str) -> float | None:
    try:
        seconds = None if word is None else number(word)
    except ValueError:
        seconds = math.nan
    if seconds is not None and not 0.0 <= seconds <= LONGEST:
        raise UsageError(f"fault '{text}': {name} '{word}' is not valid; give seconds from 0 up")
    return seconds


FaultText = Annotated[FaultSpec, parsed(parse_fault), AsText]
