"""What a run without ROS publishes: the messages that the bridge of a run with ROS would.

In the same order, as bytes, to sinks: a recording, Foxglove. Nobody listens, so there is no /cmd_vel.
"""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from itertools import chain

from harness.base.sim_time import LOOK_PERIOD_NS
from harness.episode.assembly import actor_names, scenery, sensor_rows, world_of
from harness.episode.diagnostics import METRICS
from harness.episode.maps import MAP, occupancy_bytes
from harness.messages.optional import Draw
from harness.messages.outlets import CLOCK, Outlets, bursts, clock, outlets
from harness.messages.refilled import Fill
from harness.messages.sink import Intake, Sink, endpoint
from harness.messages.transforms import DESCRIPTION, STATIC, MovingFrames, transforms_bytes, urdf_bytes
from harness.robots import find_rover
from harness.robots.frames.tree import Description
from harness.robots.lidar import LidarSpec
from harness.samples import Tick, Transforms, source
from harness.sensors.camera.painter import CameraPainter
from harness.sensors.camera.sensor import CameraOptions
from harness.sensors.table import Topic, row_of
from harness.spec.rover import CMD_VEL
from harness.spec.run import Run
from harness.world.occupancy import occupancy
from rover_metrics.errors import complain

_tell = partial(complain, "harness.run")


class _Channel:
    """One topic: what makes its messages, and where they go."""

    def __init__(self, intakes: Sequence[Intake], fill: Fill, *, on_demand: bool) -> None:
        self._intakes, self._fill, self._on_demand = intakes, fill, on_demand

    def send(self, time_ns: int, value: object) -> None:
        """Sends what is made of a sample or another value, if it is wanted and makes a message."""
        wanted = [intake for intake in self._intakes if not self._on_demand or intake.is_wanted()]
        data = self._fill(value) if wanted else None
        if data is not None:
            for intake in wanted:
                intake.take(time_ns, data)


class _RoverTopics:
    """The topics of one rover."""

    def __init__(
        self,
        run: Run,
        number: int,
        description: Description,
        sinks: Sequence[Sink],
        painter: CameraPainter,
    ) -> None:
        setup = run.rovers[number]
        self.space, self._sinks = f"/{setup.name}" if setup.name else "", sinks
        rover = find_rover(setup.robot)
        urdf, static = self.channel(DESCRIPTION, urdf_bytes), self.channel(STATIC, transforms_bytes)
        outlets = outlets_of(run, number, painter.image)
        moving = MovingFrames(description.moving)
        outlets[Transforms] = [(topic, moving.fill) for topic in row_of(Transforms).topics]
        self._channels = {
            key: [self.channel(*outlet) for outlet in some] for key, some in outlets.items()
        }
        self._map = self.channel(MAP, partial(occupancy_bytes, time_ns=LOOK_PERIOD_NS))
        self._metrics = self.channel(METRICS, bytes, is_late=True)
        self._limits = rover.slope_limit, rover.step_limit
        urdf.send(0, description.urdf)
        static.send(0, description.fixed)

    def channel(self, topic: Topic, fill: Fill, *, is_late: bool = False) -> _Channel:
        """Returns a topic of the rover."""
        name = topic.name if topic.name.startswith("/") else f"{self.space}/{topic.name}"
        opened = endpoint(topic, name)._replace(is_late=is_late)
        return _Channel([sink.open(opened) for sink in self._sinks], fill, on_demand=topic.on_demand)

    def send(self, time_ns: int, sent: Tick) -> None:
        """Sends the samples of a tick."""
        for sample in chain.from_iterable(burst.values() for burst in bursts(sent.samples)):
            for channel in self._channels[source(sample)]:
                channel.send(time_ns, sample)

    def end_tick(self, time_ns: int, metrics: bytes | None, run: Run) -> None:
        """Sends what comes after the clock: a row's metrics, and once the map."""
        if metrics is not None:
            self._metrics.send(time_ns, metrics)
        if time_ns == LOOK_PERIOD_NS:  # when a bridge has looked for listeners of its maps
            self._map.send(time_ns, occupancy(world_of(run), *self._limits))


class RunTopics:
    """The topics of a run's rovers.

    Args:
        run: What is driven.
        descriptions: Of the rovers' frames.
        sinks: Get the messages.
        at_end: Ends what draws cameras' images.
    """

    def __init__(
        self, run: Run, descriptions: Sequence[Description], sinks: Sequence[Sink], at_end: ExitStack
    ) -> None:
        self._run = run
        self._rovers = [
            _RoverTopics(run, number, each, sinks, at_end.enter_context(painter(run, number, _tell)))
            for number, each in enumerate(descriptions)
        ]
        self._clock = self._rovers[0].channel(CLOCK, clock())

    def tell(self, tick: Tick, sent: Sequence[Tick], metrics: Sequence[bytes | None]) -> None:
        """Publishes a tick.

        Args:
            tick: Of the episodes.
            sent: What faults have left of each rover's.
            metrics: Each one's message of diagnostics, where a row was due.
        """
        time_ns = tick.stamp_ns
        for rover, each in zip(self._rovers, sent, strict=True):
            rover.send(time_ns, each)
        if sent[0].tells_time:
            self._clock.send(time_ns, sent[0])
        for rover, message in zip(self._rovers, metrics, strict=True):
            rover.end_tick(time_ns, message, self._run)


def outlets_of(run: Run, number: int, draw: Draw) -> Outlets:
    """Returns what is published of each sample of a rover.

    Args:
        run: What is driven.
        number: The rover's place in it.
        draw: Gives the images of its cameras.
    """
    setup = run.rovers[number]
    return outlets(
        find_rover(setup.robot),
        LidarSpec(beams=setup.lidar_beams),
        sensor_rows(setup),
        draw=draw,
        actors=actor_names(run.world),
        goals=run.plan.route is not None and setup.driver == CMD_VEL,
    )


def painter(run: Run, number: int, tell: Callable[[str], object]) -> CameraPainter:
    """Returns what draws for the cameras of a run's rover; the first image starts it.

    Args:
        run: What is driven.
        number: The rover's place in it.
        tell: Is given the reason why there are no images.
    """
    given = (row.given for row in sensor_rows(run.rovers[number]))
    cameras = {options.name: options for options in given if isinstance(options, CameraOptions)}
    return CameraPainter(partial(scenery, run), cameras, run.own_seed(number), tell)
