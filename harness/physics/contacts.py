"""What the rover touches, step by step: the strongest contact of each kind in a clock tick.

Walks MuJoCo's contacts only in steps whose contact counts are not zero; the counts are those of the
truth sensors of harness.physics.scene.
"""

from typing import NamedTuple

import mujoco
import numpy as np

from harness.physics.scene import HAZARD_CONTACT, ROCK_CONTACT, SCRAPE_CONTACT, body_geoms
from harness.robots import RoverSpec
from harness.samples import ContactKind

BODY_PREFIX = "body_"  # of the names of geoms that are not wheels, in the models that ship
KIND_OF_BODY: dict[str, ContactKind] = {"rocks": "rock", "hazards": "hazard"}


class Touch(NamedTuple):
    """One contact point in one physics step.

    Attributes:
        force: Normal force [N].
        part: Geom of the rover; `other` is that of the obstacle or the ground.
        position: In the world [m].
        pose: The rover's then: position [m] and w, x, y, z.
    """

    force: float
    part: int
    other: int
    position: list[float]
    pose: list[float]


class ContactWatch:
    """Watches one simulation; `look` after every step whose counts are not all zero.

    Attributes:
        counts: How many contacts of each kind MuJoCo counts in the present step; a view.
        strongest: The strongest contact of each kind since the last `begin`.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, rover: RoverSpec) -> None:
        self._model, self._data = model, data
        self.counts = data.sensordata[_contact_counts(model)]
        self._obstacles: dict[int, ContactKind] = {
            geom: kind
            for body, kind in KIND_OF_BODY.items()
            for geom in np.flatnonzero(model.geom_bodyid == model.body(body).id).tolist()
        }
        people = np.flatnonzero(model.body_mocapid[model.geom_bodyid] >= 0).tolist()
        self._obstacles |= dict.fromkeys(people, "hazard")
        self._ground = set(np.flatnonzero(model.geom_bodyid == 0).tolist())  # terrain and decks
        self._body = body_geoms(model, rover)
        self._force = np.zeros(6)
        self.strongest: dict[ContactKind, Touch] = {}

    def begin(self) -> None:
        """Forgets what was touched so far."""
        if self.strongest:
            self.strongest = {}

    def look(self) -> None:
        """Takes a step in which something was touched into account."""
        for index, (one, other) in enumerate(self._data.contact.geom.tolist()):
            swapped = one in self._obstacles or one in self._ground
            part, thing = (other, one) if swapped else (one, other)
            kind = self._obstacles.get(thing) or ("scrape" if part in self._body else None)
            if kind is None:
                continue  # a wheel on the ground
            mujoco.mj_contactForce(self._model, self._data, index, self._force)
            force = float(self._force[0])
            position, pose = self._data.contact.pos[index].tolist(), self._data.qpos[:7].tolist()
            self.note(kind, Touch(force, part, thing, position, pose))

    def note(self, kind: ContactKind, touch: Touch) -> None:
        """Keeps a touch if none of its kind was stronger."""
        before = self.strongest.get(kind)
        if before is None or touch.force > before.force:
            self.strongest[kind] = touch

    def name_of(self, geom: int) -> str:
        """Returns what a part, an obstacle or the ground is called."""
        if geom in self._ground:
            return "ground"
        name: str = self._model.geom(geom).name or self._model.body(self._model.geom_bodyid[geom]).name
        return name.removeprefix(BODY_PREFIX)


def _contact_counts(model: mujoco.MjModel) -> slice:
    """Where in the sensor data the contact counts stand: one next to the other."""
    counted = (ROCK_CONTACT, HAZARD_CONTACT, SCRAPE_CONTACT)
    sensors = [model.sensor(i) for i in range(model.nsensor)]
    places = [int(s.adr[0]) for s in sensors if s.name.startswith(counted)]
    return slice(min(places), max(places) + 1)
