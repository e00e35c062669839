"""An output of the user's nodes that time waits for: TOPIC[,newer-than=INPUT][,timeout=SECONDS]."""

from typing import Annotated, Any

from pydantic import Field

from harness.base.errors import UsageError
from harness.spec.value import AsText, Value, made, parsed

FORM = "TOPIC[,newer-than=INPUT][,timeout=SECONDS]"


class Effect(Value):
    """A topic on which something must come before simulation time goes on.

    Attributes:
        topic: The output; below the rover's namespace unless it begins with "/".
        newer_than: The input: a topic of the run, each message of which must be answered by one.
        timeout: Wall time after which the answer counts as missing, and the run as failed [s].
    """

    topic: Annotated[str, Field(min_length=1)]
    newer_than: Annotated[str, Field(min_length=1)] = "scan"
    timeout: Annotated[float, Field(gt=0.0, le=3600.0)] = 30.0

    def __str__(self) -> str:
        """Returns it as a user writes it."""
        return f"{self.topic},newer-than={self.newer_than},timeout={self.timeout:g}"


def parse_effect(text: str) -> Effect:
    """Returns the output that a text names.

    Raises:
        UsageError: The text has another form.
    """
    topic, *options = (word.strip() for word in text.split(","))
    pairs = [option.partition("=") for option in options]
    if not all(equals for _, equals, _ in pairs):
        raise UsageError(f"'{text}' is not valid; give {FORM}")
    values: dict[str, Any] = {key.replace("-", "_"): value for key, _, value in pairs}
    return made(Effect, {"topic": topic} | values, f"'{text}'", lambda name: name.replace("_", "-"))


EffectText = Annotated[Effect, parsed(parse_effect), AsText]
