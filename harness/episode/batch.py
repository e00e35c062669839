"""What an episode yields, batch by batch, and what it was made of: values, no physics."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from harness.samples import ContactEvent, Place, Tick, Truth
from harness.world.world import Start


@dataclass(frozen=True, slots=True)
class EpisodeInfo:
    """What an episode was made of, for the manifest.

    Attributes:
        model_hash: SHA-256 of the rover's model file; `terrain_hash` is that of heights and obstacles.
        map_size: Its lengths along x and y [m].
        start: Where the rover started: x, y [m], yaw [rad] of its model frame in the world.
        notes: What a file holds, and what was done to it to make this map of it.
        files: Those that it was read from, each with its SHA-256.
        targets: Where on the ground each stands, by name: x, y, z in the world [m].
    """

    model_hash: str
    terrain_hash: str
    obstacles: int
    map_size: tuple[float, float]
    start: Start
    notes: tuple[str, ...] = ()
    files: tuple[tuple[str, str], ...] = ()
    targets: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Batch:
    """The ticks of one control period and the truth at their end.

    Attributes:
        events: Contact events that ended; with the last batch of an episode all are.
        open_events: Those that had not, as they stood at the end: what an interrupted run has of them.
        goals: Those that the driver was given before its first tick.
    """

    ticks: tuple[Tick, ...]
    truth: Truth
    events: tuple[ContactEvent, ...] = ()
    open_events: tuple[ContactEvent, ...] = ()
    goals: tuple[Place, ...] = ()


def later(batch: Batch, by_ns: int) -> Batch:
    """Returns the batch as of an episode that began so much later [ns]."""
    if not by_ns:
        return batch

    def moved(event: ContactEvent) -> ContactEvent:
        return replace(event, start_ns=event.start_ns + by_ns, end_ns=event.end_ns + by_ns)

    def stamped(tick: Tick) -> Tick:
        samples = (replace(sample, stamp_ns=sample.stamp_ns + by_ns) for sample in tick.samples)
        return replace(tick, stamp_ns=tick.stamp_ns + by_ns, samples=tuple(samples))

    return replace(
        batch,
        ticks=tuple(map(stamped, batch.ticks)),
        truth=replace(batch.truth, time_ns=batch.truth.time_ns + by_ns),
        events=tuple(map(moved, batch.events)),
        open_events=tuple(map(moved, batch.open_events)),
    )
