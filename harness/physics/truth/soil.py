"""What the wheels of a rover do in soil, and whether it is stuck."""

import numpy as np

from harness.physics.simulation import Simulation
from harness.samples import SoilState

TURNS = 0.05  # [m/s] of the rims, on average, from which on a rover wants to go on
ADVANCE = 0.1  # share of that speed below which its wheels do not get on
LASTING = 20  # states of 20 Hz, one after the other


class SoilWheels:
    """What soil does to the wheels of a simulation's rover, in the order of its wheel joints."""

    def __init__(self, simulation: Simulation) -> None:
        bed = simulation.physics.bed
        if bed is None:
            raise ValueError("rigid ground has no soil")
        self._felt = bed.felt[bed.wheels_of(simulation.scene.root)]
        self._bodies = [wheel.body for wheel in bed.wheels if wheel.root == simulation.scene.root]
        self._data = simulation.data
        self._spinning = 0

    def state(self) -> SoilState:
        """Returns the present state; to be called with each state of the truth, 20 times a second.

        A rover is stuck when its rims have turned for a second while its wheels stayed, turning on the
        spot being no standing: what counts is how fast the hubs move over the ground.
        """
        sinkage, ahead, left, _, rim, along, across, rut = self._felt.T
        hubs = np.hypot(along, across)
        turning = float(np.abs(rim).mean())
        held = turning >= TURNS and float(hubs.mean()) < ADVANCE * turning
        self._spinning = self._spinning + 1 if held else 0
        x, y, _ = self._data.xpos[self._bodies].T.tolist()
        angles = np.where(hubs < 0.1 * TURNS, 0.0, np.arctan2(across, np.abs(along)))
        return SoilState(
            sinkage=tuple(np.maximum(sinkage, 0.0).tolist()),
            slip_angle=tuple(angles.tolist()),
            pull=tuple(ahead.tolist()),
            side_force=tuple(left.tolist()),
            stuck=self._spinning >= LASTING,
            ruts=tuple(zip(x, y, np.maximum(sinkage, rut).tolist(), strict=True)),
        )

    def begin_anew(self) -> None:
        """Takes note that the rover was put elsewhere."""
        self._spinning = 0
