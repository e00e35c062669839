"""Optional lidars: planar ones, and 3-D ones with rings or a pattern; presets after products.

Angles are in the sensor's frame, counter-clockwise from its x axis, elevations from its xy plane. All
rays of a reading are cast at its stamp: there is no distortion by motion, and nothing to undo.
"""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from harness.sensors.ranging import RangeOptions
from harness.spec.value import Length, NotNegative

DEGREE = math.pi / 180.0
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
RINGS: Final = "rings"
SPIRAL: Final = "spiral"
LEFT_OUT: Final = "left_out"
AS_NAN: Final = "nan"


class PlanarLidarOptions(RangeOptions):
    """A lidar whose beams lie in its xy plane.

    Attributes:
        preset: Name of values of the others.
        beams: How many there are, both ends of the field of view included.
        angle_min: Azimuth of the first beam [rad].
        angle_max: Azimuth of the last [rad].
    """

    # The makers' documents were not read; docs/sensors.md has the sources of the numbers.
    # RPLIDAR S2: 0.05-30 m, 32,000 samples a second, 10 Hz: 0.1125 deg.
    # Hokuyo UTM-30LX: 270 deg, 0.25 deg, 0.1-30 m, 25 ms a scan; 40 Hz are no whole number of the
    # clock's ticks of 10 ms.
    presets: ClassVar[Mapping[str, Mapping[str, object]]] = {
        "rplidar_s2": {},  # the defaults
        "planar_270": {
            "beams": 1081,
            "angle_min": -135.0 * DEGREE,
            "angle_max": 135.0 * DEGREE,
            "range_min": 0.1,
            "rate": 25,
        },
    }

    preset: str = "rplidar_s2"
    beams: Annotated[int, Field(ge=2)] = 3200
    angle_min: float = -math.pi
    angle_max: float = math.pi - 0.1125 * DEGREE
    range_min: NotNegative = 0.05
    range_max: Length = 30.0

    @property
    def rays(self) -> int:
        """Number of beams."""
        return self.beams

    def directions(self) -> NDArray[np.float64]:
        """Returns unit vectors, shape (beams, 3)."""
        azimuths = np.linspace(self.angle_min, self.angle_max, self.beams)
        return _unit_vectors(azimuths, np.zeros(self.beams))

    @model_validator(mode="after")
    def _check_field_of_view(self) -> Self:
        _check_span("a field of view", self.angle_min, self.angle_max, math.pi)
        return self


class CloudLidarOptions(RangeOptions):
    """A lidar with beams at several elevations.

    Attributes:
        preset: Name of values of the others.
        rings: How many elevations there are, evenly from `lowest` to `highest`.
        lowest: Elevation of the lowest ring [rad].
        highest: Elevation of the highest ring [rad].
        elevations: Instead of those three: all of them [rad], from the lowest to the highest.
        columns: Directions around, from `angle_min` to `angle_max`.
        angle_min: Azimuth of the first column [rad].
        angle_max: Azimuth of the last [rad]; all around, it is that of the first and left out.
        pattern: rings; or spiral: rings * columns points spread evenly over the field of view by the
            golden ratio, in place of rings.
        organised: Whether the cloud is an image: rings, the highest first, by columns.
        misses: What becomes of beams that meet nothing or something too near: left_out, or nan, as they
            always are in an organised cloud.
    """

    # Of these only Ouster's data sheet was read; docs/sensors.md has the sources of the others.
    # VLP-16: 16 channels from -15 to 15 deg, 100 m, 0.2 deg around at 600 rpm. 0.5 m is an estimate.
    # Ouster, OS1 data sheet (first generation): 64 channels from -16.6 to 16.6 deg, 1024 around, 10 Hz,
    # 0.8-120 m.
    # Livox Mid-360: 360 deg by -7..52 deg, 200,000 points a second, 10 Hz, 0.1 m, 70 m at 80 %
    # reflectivity. Its own pattern does not repeat itself; this one does.
    presets: ClassVar[Mapping[str, Mapping[str, object]]] = {
        "vlp16": {},  # the defaults
        "os1_64": {
            "rings": 64,
            "lowest": -16.6 * DEGREE,
            "highest": 16.6 * DEGREE,
            "columns": 1024,
            "range_min": 0.8,
            "range_max": 120.0,
        },
        "livox": {
            "rings": 40,
            "lowest": -7.0 * DEGREE,
            "highest": 52.0 * DEGREE,
            "columns": 500,
            "pattern": SPIRAL,
            "range_min": 0.1,
            "range_max": 70.0,
        },
    }

    preset: str = "vlp16"
    rings: Annotated[int, Field(ge=1)] = 16
    lowest: float = -15.0 * DEGREE
    highest: float = 15.0 * DEGREE
    elevations: tuple[float, ...] = ()
    columns: Annotated[int, Field(ge=1)] = 1800
    angle_min: float = -math.pi
    angle_max: float = math.pi
    pattern: Literal["rings", "spiral"] = RINGS
    organised: bool = False
    misses: Literal["left_out", "nan"] = LEFT_OUT
    range_min: NotNegative = 0.5
    range_max: Length = 100.0

    @property
    def rays(self) -> int:
        """Number of points of a cloud without misses."""
        return (len(self.elevations) or self.rings) * self.columns

    @property
    def ring(self) -> NDArray[np.uint16]:
        """Number of each ray's ring from the lowest, 0, shape (rays,); 0 of a spiral's."""
        rings = len(self.elevations) or self.rings
        if self.pattern == SPIRAL:
            return np.zeros(self.rays, np.uint16)
        return np.repeat(np.arange(rings, dtype=np.uint16)[::-1], self.columns)

    def directions(self) -> NDArray[np.float64]:
        """Returns unit vectors, shape (rays, 3): ring by ring from the highest, each around."""
        span = self.angle_max - self.angle_min
        if self.pattern == SPIRAL:
            places = np.arange(self.rays)
            azimuths = self.angle_min + span * np.mod(places * GOLDEN, 1.0)
            sines = np.linspace(math.sin(self.lowest), math.sin(self.highest), self.rays)
            return _unit_vectors(azimuths, np.arcsin(sines))
        around = span >= math.tau - 1e-4
        azimuths = np.linspace(self.angle_min, self.angle_max, self.columns, endpoint=not around)
        elevations = np.array(self.elevations or np.linspace(self.lowest, self.highest, self.rings))
        rows = np.repeat(elevations[::-1], self.columns)
        return _unit_vectors(np.tile(azimuths, len(elevations)), rows)

    @model_validator(mode="after")
    def _check_field_of_view(self) -> Self:
        _check_span("a field of view", self.angle_min, self.angle_max, math.pi)
        given = self.elevations or (self.lowest, self.highest)
        if len(self.elevations or range(self.rings)) > 1:
            _check_span("elevations", given[0], given[-1], math.pi / 2)
        if list(self.elevations) != sorted(self.elevations):
            raise ValueError("elevations are not valid; give them from the lowest to the highest")
        if self.pattern == SPIRAL and (self.organised or self.elevations):
            raise ValueError(
                "a spiral has no rings: leave out organised and elevations, or give pattern: rings"
            )
        return self


def _check_span(name: str, low: float, high: float, widest: float) -> None:
    """Checks that an angle goes from a lower to a higher one [rad], both at most `widest` from 0."""
    if not -widest - 1e-4 <= low < high <= widest + 1e-4:
        raise ValueError(
            f"{name} from {low:g} to {high:g} rad is not valid; give a lower angle and a higher one, "
            f"from {-widest:.6g} to {widest:.6g}"
        )


def _unit_vectors(azimuth: NDArray[np.float64], elevation: NDArray[np.float64]) -> NDArray[np.float64]:
    level = np.cos(elevation)
    return np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])
