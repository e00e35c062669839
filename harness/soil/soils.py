"""Soils: a table like that of the terrains, and files of one's own.

Numbers are those of a source that was read; what it does not state has a default that does nothing.
"""

import math
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from harness.base.documents import read_mapping
from harness.base.errors import find_named
from harness.spec.value import Share, Value, made
from rover_metrics.plugins import Table

SOIL_CONTACT = 1 << 30  # MuJoCo's contact bit of soil and of what is no wheel
SUFFIXES = (".yaml", ".yml")
# What is beyond these is no soil: it carries nothing, or steps of physics cannot follow it.
Modulus = Annotated[float, Field(ge=0.0, le=1e12)]
Weight = Annotated[float, Field(ge=0.0, le=100.0)]
Exponent = Annotated[float, Field(gt=0.0, le=10.0)]
Factor = Annotated[float, Field(ge=-0.9, le=100.0)]

# What kernels take, in their order; `harness.soil.rim` reads those up to `stay_lateral`.
NUMBERS = (
    "k", "n", "slip_n", "cohesion", "friction", "shear_length", "peak", "peak_driving", "peak_braking",
    "flowing", "flow_lateral", "flow_driving", "flow_braking", "flow_pressing", "dig_grousers",
    "grouser_friction", "grouser_shear", "stay_braking", "stay_lateral", "rebound", "side_modulus",
    "side_exponent", "side_flow", "side_slip", "side_friction", "side_cohesion", "damping",
)  # fmt: skip


class Soil(Value):
    """A soil in SI units; one without a word on flow, digging and grousers is Wong and Reece's."""

    summary: str = Field(default="", description="what it is, in a line")
    source: str = Field(default="", description="where the numbers come from")
    k_c: Modulus = Field(default=0.0, description="cohesive modulus of pressure [N/m^(n+1)]")
    k_phi: Modulus = Field(description="frictional modulus of pressure [N/m^(n+2)]")
    n: Annotated[float, Field(ge=0.2, le=4.0)] = Field(description="exponent of the sinkage")
    slip_n: Annotated[float, Field(ge=0.0, le=2.0)] = Field(
        default=0.0, description="what a slip of 1 adds to n"
    )
    cohesion: Annotated[float, Field(ge=0.0, le=1e6)] = Field(default=0.0, description="[Pa]")
    friction_angle_deg: Annotated[float, Field(gt=0.0, le=60.0)] = Field(description="internal friction")
    shear_length: Annotated[float, Field(gt=0.0, le=1.0)] = Field(
        description="Janosi's K: slid path of 63 % of the strength [m]"
    )
    rebound: Share = Field(
        default=0.0, description="share that presses against a wheel's rear half while it rolls"
    )
    damping: Weight = Field(
        default=2.0, description="growth of the pressure with the sinking speed [s/m]"
    )
    peak: Share = Field(
        default=0.4, description="place of the highest pressure, share of the entry angle"
    )
    peak_driving: Annotated[float, Field(ge=-1.0, le=1.0)] = Field(
        default=0.2, description="what a slip of 1 adds to `peak`"
    )
    peak_braking: Annotated[float, Field(ge=-1.0, le=1.0)] = Field(
        default=0.0, description="what a slip of -1 adds to `peak`"
    )
    flowing: Share = Field(
        default=1.0, description="share of the pressure that is left where soil flows away"
    )
    flow_lateral: Weight = Field(default=1.0, description="weight of sideways motion in it")
    flow_driving: Weight = Field(default=1.0, description="weight of driving slip in it")
    flow_braking: Weight = Field(default=1.0, description="weight of braking slip in it")
    flow_pressing: Weight = Field(default=0.0, description="weight of sinking straight down in it")
    dig_grousers: Weight = Field(
        default=0.0, description="the pressure under grousers falls by exp(-it) as they spin on the spot"
    )
    grouser_friction: Factor = Field(default=0.0, description="what grousers add to friction")
    grouser_shear: Factor = Field(default=0.0, description="what grousers add to the shear length")
    stay_braking: Weight = Field(
        default=1.0, description="speed at which a braked wheel leaves the soil, per slip speed"
    )
    stay_lateral: Weight = Field(default=1.0, description="the same, per sideways speed")
    side_modulus: Modulus | None = Field(
        default=None,
        description="force beside the wheel per length [N/m^(1+side_exponent)]; default: Hegedus 1960",
    )
    side_exponent: Exponent = Field(default=2.0, description="of the sinkage in it")
    side_flow: Exponent = Field(default=1.0, description="exponent of the sideways share of the motion")
    side_slip: Weight = Field(default=1.0, description="weight of the rim's slip in that share")
    side_friction: Share = Field(default=0.0, description="friction on the wheel's face")
    density: Annotated[float, Field(gt=0.0, le=1e4)] = Field(
        default=1500.0, description="for the force beside the wheel [kg/m^3]"
    )

    @property
    def leaves_ruts(self) -> bool:
        """Whether it stays where it was pressed to."""
        return self.rebound < 1.0

    def numbers(self, width: float, gravity: float) -> NDArray[np.float64]:
        """Returns the soil as the kernels take it, for a wheel that wide [m] and a gravity [m/s^2]."""
        phi = math.radians(self.friction_angle_deg)
        # Hegedus 1960 in the form of Ishigami et al. 2007: a wedge at 45 deg - phi / 2 is pushed away.
        wedge = math.radians(45.0) - 0.5 * phi
        cot = 1.0 / math.tan(wedge)
        cohesive, weight = cot + math.tan(wedge + phi), cot + cot * cot * math.tan(phi)
        side = self.side_modulus
        if side is None:
            side = 0.5 * cohesive * weight * self.density * gravity
        given = self.model_dump() | {
            "k": self.k_c / width + self.k_phi,
            "friction": math.tan(phi),
            "side_modulus": side,
            "side_slip": self.side_slip**2,
            "side_cohesion": cohesive * self.cohesion,
        }
        return np.array([given[name] for name in NUMBERS])


LLL = "Land Locomotion Laboratory, in gz-terramechanics (unitsSpaceLab), soil_params.yaml"
SHIPPED = {
    "dry_sand": Soil(
        summary="dry sand, fitted to 234 trials of single wheels",
        source="C. Pavlov, Carnegie Mellon University 2022: 3d-terramechanics; fit in docs/soil.md",
        k_phi=7.526e7,
        n=1.6,
        friction_angle_deg=33.24,
        shear_length=0.00677,
        peak=0.585,
        peak_driving=0.0,
        peak_braking=0.25,
        flowing=0.0302,
        flow_lateral=7.326,
        flow_driving=6.132,
        flow_braking=5.419,
        flow_pressing=7.8,
        dig_grousers=1.419,
        grouser_friction=0.9585,
        grouser_shear=1.445,
        stay_braking=6.609,
        stay_lateral=6.596,
        side_modulus=2.179e5,
        side_flow=0.3,
        side_slip=3.1623,
        side_friction=0.3379,
    ),
    "lll_sand": Soil(
        summary="dry sand of tables, rather firm",
        source=LLL,
        k_c=0.99e3,
        k_phi=1528.43e3,
        n=1.10,
        cohesion=1040.0,
        friction_angle_deg=28.0,
        shear_length=0.010,
    ),
    "clay": Soil(
        summary="clay",
        source=LLL,
        k_c=13.19e3,
        k_phi=692.15e3,
        n=0.5,
        cohesion=4140.0,
        friction_angle_deg=13.0,
        shear_length=0.006,
    ),
    "lunar": Soil(
        summary="lunar soil",
        source=LLL,
        k_c=1.4e3,
        k_phi=820e3,
        n=1.0,
        cohesion=170.0,
        friction_angle_deg=35.0,
        shear_length=0.018,
    ),
    "firm": Soil(
        summary="ground that hardly gives way, elastic: rigid ground at a lower price",
        source="chosen: a wheel sinks in by 1 mm under 30 N, friction 1 as that of MuJoCo",
        k_phi=4.0e7,
        n=1.0,
        friction_angle_deg=45.0,
        shear_length=0.0005,
        rebound=1.0,
        peak=0.0,
        peak_driving=0.0,
        side_modulus=0.0,
    ),
}
SOILS = Table[Soil]("soils", SHIPPED, lambda value: isinstance(value, Soil), "a harness.soil.soils.Soil")


def find_soil(name: str) -> Soil:
    """Returns a soil by its name, or of a YAML file; UsageError names what is valid."""
    if name in SOILS or not name.lower().endswith(SUFFIXES):
        return find_named("soil", name, SOILS)
    return made(Soil, read_mapping(Path(name)), where=name)
