"""All tracks; the command shows them in this order."""

from harness.base.errors import find_named
from harness.course.tracks.barn import Barn
from harness.course.tracks.base import SEEDS, Track
from harness.course.tracks.ground import Ground

__all__ = ["SEEDS", "TRACKS", "Track", "find_track"]

TRACKS: dict[str, Track] = {
    track.name: track
    for track in (
        Barn(),
        Ground(
            name="rocky",
            summary="to a point behind boulders, over rocks",
            world={"terrain": "rocky", "difficulty": 1.0},
        ),
    )
}


def find_track(name: str) -> Track:
    """Returns the track of that name; UsageError, which lists them, without one."""
    return find_named("track", name, TRACKS)
