"""All tracks; the command shows them in this order."""

from harness.base.errors import find_named
from harness.course.tracks.base import SEEDS, Track
from rover_metrics.plugins import Shipped

__all__ = ["SEEDS", "TRACKS", "Track", "find_track"]

TRACKS = Shipped[Track](
    "harness.course.tracks",
    {
        "barn": ".barn:BARN",
        "dynabarn": ".dynabarn:DYNABARN",
        "rocky": ".grounds:ROCKY",
        "dunes": ".grounds:DUNES",
        "marsyard": ".grounds:MARSYARD",
        "mission": ".grounds:MISSION",
        "blind": ".grounds:BLIND",
    },
)


def find_track(name: str) -> Track:
    """Returns the track of that name; UsageError, which lists them, without one."""
    return find_named("track", name, TRACKS)
