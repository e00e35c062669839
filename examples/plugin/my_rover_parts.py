"""One of each thing that a package can add to rover-harness; docs/extend.md explains them."""

import math
from dataclasses import dataclass

import numpy as np

from harness.drivers.base import DriverContext, Observation
from harness.faults.base import Kind
from harness.faults.readings import measured
from harness.gym.custom import Sight, StepTruth
from harness.samples import Twist
from harness.scenario.quantities import Quantity
from harness.sensors.optional import OptionalSensor, SensorOptions
from harness.sensors.table import SensorRow, Topic
from harness.soil.soils import Soil
from harness.world.heightfield import Field
from harness.world.statistics import Promise
from harness.world.terrain import Terrain, parameter
from rover_metrics.core.columns import Cell, Column
from rover_metrics.core.rotation import Vector3
from rover_metrics.extended.further import Columns


@dataclass(frozen=True, kw_only=True)
class Crater(Terrain):
    name = "crater"
    summary = "a bowl with a rim 8 m around its middle"
    promise = Promise(slope_p95=(5.0, 25.0))

    depth: float = parameter(0.3, 1.0, 2.0, "m")

    def _heights(self, x: Field, y: Field, rng: np.random.Generator, /) -> Field:
        rim = np.exp(-((np.hypot(x, y) - 8.0) ** 2) / 8.0)
        return self.depth * rim + rng.normal(0.0, 0.005, x.shape)


REGOLITH = Soil(summary="loose dust", k_phi=9e5, n=1.1, friction_angle_deg=32.0, shear_length=0.015)


class Weave:
    """Drives on in a slalom."""

    summary = "drives on, half a metre left and right"
    senses = frozenset()

    def __init__(self, context: DriverContext) -> None:
        self._rover = context.rover

    def command(self, observation: Observation) -> Twist:
        rate = 0.5 * self._rover.cruise_yaw_rate * math.cos(observation.time_ns / 1e9)
        return Twist(self._rover.cruise_speed, rate)


@dataclass(frozen=True, slots=True)
class Tilt:
    stamp_ns: int
    sensor: str
    data: float  # [rad], as std_msgs/Float64 calls it


class Inclinometer(OptionalSensor[SensorOptions]):
    """The angle between the rover's and the world's vertical."""

    def read(self) -> Tilt:
        up = self.pose()[3, 2]
        return Tilt(self._simulation.time_ns, self.name, math.acos(max(-1.0, min(1.0, float(up)))))


INCLINOMETER = SensorRow(
    sample=Tilt,
    factory=Inclinometer,
    topics=(Topic("tilt", "std_msgs/msg/Float64"),),
    fault="inclinometer",
    measured=("data",),
    options=SensorOptions,
    summary="the rover's tilt",
)

HALVED = Kind("halved", "values are half as large", measured(lambda v, _, __: 0.5 * v), of_values=True)


class Climb(Columns):
    """How far the rover went uphill."""

    COLUMNS = (
        Column(
            name="Climb",
            unit="m",
            meaning="Metres uphill so far.",
            formula="Sum of rises.",
            source="pose",
        ),
    )
    _climb, _last = 0.0, math.inf

    def add_pose(self, stamp_ns: int, position: Vector3) -> None:
        self._climb += max(0.0, position[2] - self._last)
        self._last = position[2]

    def cells(self) -> tuple[Cell, ...]:
        return (self._climb,)


FROM_ORIGIN = Quantity("m", "From the world's origin.", lambda m: math.hypot(*m.truth.position[:2]))


def calm(truth: StepTruth, action: np.ndarray) -> dict[str, float]:
    """Nearer to the goal, and level."""
    return {
        "progress": truth.progress,
        "tilt": -0.1 * truth.tilt,
        "effort": -0.01 * float(np.abs(action).sum()),
    }


def brief(truth: StepTruth) -> bool:
    """Ends an episode after a second."""
    return truth.time_s > 0.99


HEADING = Sight((-1.0,) * 2, (1.0,) * 2, lambda truth: (math.cos(truth.yaw), math.sin(truth.yaw)))
