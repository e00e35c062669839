"""An optional sensor as a user asks for it: NAME or NAME=PRESET, e.g. lidar3d=vlp16.

Which names and presets exist is known to harness.sensors and to the rover's rover.yaml.
"""

from dataclasses import dataclass
from typing import Annotated

from pydantic import BeforeValidator, PlainSerializer

from harness.base.errors import UsageError
from harness.spec.value import AsText, as_tuple, parsed

NONE = "none"  # alone: without the sensors of rover.yaml


@dataclass(frozen=True)
class SensorChoice:
    """An optional sensor that a rover is to carry.

    Attributes:
        name: Of a sensor in rover.yaml, or a kind of sensor.
        preset: Of its options; "" for its defaults.
    """

    name: str
    preset: str = ""

    def __str__(self) -> str:
        """Returns it as a user writes it."""
        return f"{self.name}={self.preset}" if self.preset else self.name


def parse_choice(text: str) -> SensorChoice:
    """Returns the sensor that a text asks for; UsageError if nothing stands behind its "="."""
    name, equals, preset = text.strip().partition("=")
    if equals and not preset:
        raise UsageError(f"'{text}' names no preset; give {name} alone, or {name}=PRESET")
    return SensorChoice(name, preset)


def _split(value: object) -> object:
    """Splits a comma-separated text; "none" alone is no sensor at all."""
    words: object = value.split(",") if isinstance(value, str) else value
    if isinstance(words, list | tuple) and [str(word).strip() for word in words] == [NONE]:
        return ()
    return as_tuple(words)


def _shown(choices: tuple[SensorChoice, ...] | None) -> list[str] | None:
    return None if choices is None else [str(choice) for choice in choices] or [NONE]


_Choice = Annotated[SensorChoice, parsed(parse_choice), AsText]
# None: the sensors of rover.yaml; (): none at all.
SensorChoices = Annotated[
    tuple[_Choice, ...] | None, BeforeValidator(_split), PlainSerializer(_shown, return_type=object)
]
