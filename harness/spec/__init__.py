"""What determines a run, as frozen values without look-ups; everything else reads these."""

from harness.spec.plan import Plan
from harness.spec.rover import RoverSetup
from harness.spec.run import Run
from harness.spec.world import WorldSpec

__all__ = ["Plan", "RoverSetup", "Run", "WorldSpec"]
