"""What an episode yields, batch by batch, and what it was made of: values, no physics."""

from dataclasses import dataclass

from harness.samples import Tick, plain_value
from harness.truth.traversal import ContactEvent, Truth
from harness.world.world import Start


@dataclass(frozen=True, slots=True)
class EpisodeInfo:
    """What an episode was made of, for the manifest.

    Attributes:
        model_hash: SHA-256 of the rover's model file; `terrain_hash` is that of heights and obstacles.
        obstacles: How many there are.
        map_size: Its lengths along x and y [m].
        start: Where the rover started: x, y [m], yaw [rad] of its model frame in the world.
        notes: What a heightmap file holds, and what was done to it to make this map of it.
    """

    model_hash: str
    terrain_hash: str
    obstacles: int
    map_size: tuple[float, float]
    start: Start
    notes: tuple[str, ...] = ()


@plain_value
class Batch:
    """The ticks of one control period and the truth at their end.

    Attributes:
        events: Contact events that ended; with the last batch of an episode all are.
        open_events: Those that had not, as they stood at the end: what an interrupted run has of them.
    """

    ticks: tuple[Tick, ...]
    truth: Truth
    events: tuple[ContactEvent, ...] = ()
    open_events: tuple[ContactEvent, ...] = ()
