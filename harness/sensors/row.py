"""What a row of the table of sensors says: what is read, how often, in which frame, on which topics."""

from collections.abc import Callable
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import Any

from harness.base.sim_time import period_ticks
from harness.robots import RoverSpec
from harness.samples import Sample, Source
from harness.sensors.base import EpisodeParts, Sensor
from harness.sensors.noise import NoisePreset
from harness.sensors.optional import Installation, SensorOptions

# Gives an optional sensor its place, its generator and its noise.
Install = Callable[[SensorOptions], Installation[Any]]


@dataclass(frozen=True)
class Topic:
    """Where the samples of a sensor are published; keep-last."""

    name: str  # relative to the namespace of the run
    # e.g. "sensor_msgs/msg/Imu". Unless harness.messages.fillers has one of it, its fields are
    # filled from those of the sample that have the same names
    message_type: str
    best_effort: bool = False  # whether it is offered best effort instead of reliable
    depth: int = 10  # how many messages may wait
    # whether late subscribers get the last ones too (transient local); else volatile
    latched: bool = False
    # the field of the sensor's options that must be true for the topic to be there, if any
    option: str = ""
    on_demand: bool = False  # whether only those messages count that somebody listens to or records


@dataclass(frozen=True, kw_only=True)
class SensorRow:
    """One sensor."""

    # what it reads: a frozen dataclass with a stamp_ns; of an optional one, with its name in
    # `sensor` too
    sample: type[Sample]
    # the Sensor class, or "module:Class", which is loaded when one is made
    factory: str | type[Sensor]
    topics: tuple[Topic, ...]  # where the sample is published, in this order; options complete the names
    # samples a second of simulation time, of every rover or by rover [Hz], or of its options
    rate: int | Callable[[RoverSpec], int] = 0
    # frame of the messages' headers, of every rover or by rover, or of its options
    frame: str | Callable[[RoverSpec], str] = ""
    fault: str | None = None  # its name in --fault, and in --sensors; None if no fault touches it
    measured: tuple[str, ...] = ()  # the fields of the sample that faults of values change
    # the fields that faults of values change with ATTITUDE behind the sensor's name
    attitude: tuple[str, ...] = ()
    # the options of an optional one; None if every rover has it
    options: type[SensorOptions] | None = None
    given: SensorOptions | None = None  # the options of one that is carried
    # what corrupts it in this run, for the covariances of its messages
    noise: NoisePreset | None = None
    summary: str = ""  # a line for lists and the docs

    @property
    def source(self) -> Source:
        """What its samples are known by."""
        return self.sample if self.given is None else self.given.name

    def rate_on(self, rover: RoverSpec) -> int:
        """Returns the default rate on that rover [Hz]."""
        return self.rate if isinstance(self.rate, int) else self.rate(rover)

    def frame_on(self, rover: RoverSpec) -> str:
        """Returns the name of the frame on that rover."""
        return self.frame if isinstance(self.frame, str) else self.frame(rover)

    def make(self, parts: EpisodeParts, rate: int, install: Install | None) -> Sensor | None:
        """Returns the sensor of an episode, of a rate [Hz]; None if the episode lacks a part of it."""
        kind: Any = resolve_name(self.factory) if isinstance(self.factory, str) else self.factory
        made: Sensor | None = None
        if self.given is None:
            made = kind.of(parts, period_ticks(rate))
        elif install is not None:
            made = kind(parts.simulation, install(self.given), period_ticks(rate))
        return made
