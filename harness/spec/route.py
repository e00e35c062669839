"""Way points of a mission in their order, with how near is near enough and how long each may take.

As text: X,Y/NAME/@LAT,LON[:KEY=VALUE,...]; NAME is a target's, the keys are `radius`, `within`, `stop`,
`order` and `limit`. A file may give a mapping or a list of way points instead.
"""

import re
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from harness.base.errors import UsageError
from harness.spec.target import NAME
from harness.spec.value import Finite, Latitude, Length, Longitude, Value, as_tuple, made, words_of
from rover_metrics import number

FORM = "X,Y/TARGET/@LAT,LON[:KEY=VALUE,...]"
TEXT = re.compile(r"(?P<points>[^:]+)(?::(?P<options>.*))?", re.DOTALL)
PAIR = re.compile(rf"(?P<at>@)?({number.FORM}),({number.FORM})")
RADIUS = 1.0  # [m]
OF_POINTS, OF_ROUTE = ("radius", "within", "stop"), ("order", "limit")


class WayPoint(Value):
    """A place to go to: `at`, or `lat` and `lon`, or a target's name.

    Attributes:
        at: x and y in the world [m].
        lat, lon: Degrees on WGS-84, about the world's datum.
        target: The name of a target; a gate is passed between its posts.
        radius: How near is near enough [m].
        within: How long it may take from the way point before, or from the start [s]; then it is missed.
        stop: Whether it is reached only by standing there for a second; a gate is passed all the same.
    """

    at: Annotated[tuple[Finite, Finite], BeforeValidator(as_tuple)] | None = None
    lat: Latitude | None = None
    lon: Longitude | None = None
    target: str = ""
    radius: Length = RADIUS
    within: Length | None = None
    stop: bool = False

    @model_validator(mode="after")
    def _has_one_place(self) -> Self:
        places = [self.at is not None, self.lat is not None and self.lon is not None, self.target != ""]
        if sum(places) != 1 or (self.lat is None) != (self.lon is None):
            raise ValueError(
                "a way point is one place: give at: [X, Y], or lat and lon, or target: NAME"
            )
        return self


class Route(Value):
    """Way points of a mission.

    Attributes:
        points: At least one.
        order: `given`, or `any`: then the nearest is gone to first.
        limit: How long all may take from the start on [s].
    """

    points: Annotated[
        tuple[WayPoint, ...], Field(min_length=1, max_length=1000), BeforeValidator(as_tuple)
    ]
    order: Literal["given", "any"] = "given"
    limit: Length | None = None


def parse_route(text: str) -> dict[str, Any]:
    """Returns the fields of a route that a text asks for; UsageError if it is not of that form."""
    match = TEXT.fullmatch(text.strip())
    if match is None:
        raise UsageError(f"route '{text}' is not valid; give {FORM}")
    if "/" in (match["options"] or ""):
        raise UsageError(
            f"route '{text}': keys stand behind the last way point and hold for all; "
            "in a file (docs/missions.md) each can have its own"
        )
    given = words_of(match["options"] or "", (*OF_POINTS, *OF_ROUTE), f"route '{text}': ")
    shared = {key: given[key] for key in OF_POINTS if key in given}
    points = [_point(text, word) | shared for word in match["points"].split("/")]
    return {"points": points} | {key: given[key] for key in OF_ROUTE if key in given}


def _point(text: str, word: str) -> dict[str, Any]:
    pair = PAIR.fullmatch(word)
    if pair is None:
        if not NAME.fullmatch(word):
            raise UsageError(f"route '{text}': '{word}' is no place; give {FORM}")
        return {"target": word}
    _, one, other = pair.groups()
    return {"lat": one, "lon": other} if pair["at"] else {"at": (one, other)}


def _fields(value: object) -> object:
    """A text as a route, whose numbers are text where a file's must be none; a list as its fields."""
    if isinstance(value, str):
        try:
            return made(Route, parse_route(value), f"route '{value}'")
        except UsageError as error:
            raise ValueError(str(error)) from error
    return {"points": tuple(value)} if isinstance(value, list | tuple) else value


RouteText = Annotated[
    Route, BeforeValidator(_fields, json_schema_input_type=str | tuple[WayPoint, ...] | Route)
]
