"""What a rover touches, step by step: the strongest contact of each kind in a clock tick.

Walks MuJoCo's contacts only in steps whose contact counts are not zero; the counts are those of the
truth sensors of harness.physics.scene.
"""

from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from harness.physics.scene import HAZARD_CONTACT, ROCK_CONTACT, SCRAPE_CONTACT, Scene, body_geoms
from harness.samples import ContactKind

COUNTED = ROCK_CONTACT, HAZARD_CONTACT, SCRAPE_CONTACT
BODY_PREFIX = "body_"  # of the names of geoms that are not wheels, in the models that ship
KIND_OF_BODY: dict[str, ContactKind] = {"rocks": "rock", "hazards": "hazard"}


class Touch(NamedTuple):
    """One contact point in one physics step."""

    force: float  # along the normal [N]
    part: int  # geom of the rover
    other: int  # geom of the obstacle, the other rover or the ground
    position: list[float]  # in the world [m]
    pose: list[float]  # the rover's then: position [m] and w, x, y, z


class ContactWatch:
    """Watches one rover; `look` after every step whose counts are not all zero.

    Args:
        scenes: Of all rovers of the world, the watched one first.
        data: Their state.

    Attributes:
        counts: How many contacts of each kind MuJoCo counts in the present step; a view.
        places: Where they stand among MuJoCo's sensor values.
        strongest: The strongest contact of each kind in the tick that is shown.
    """

    def __init__(self, scenes: Sequence[Scene], data: mujoco.MjData) -> None:
        scene, *others = scenes
        model = scene.model
        self._model, self._data = model, data
        counts = [at for name, at in scene.sensors().items() if name.startswith(COUNTED)]
        self.places = np.arange(counts[0].start, counts[-1].stop)  # one next to the other
        self.counts = data.sensordata[counts[0].start : counts[-1].stop]
        self._pose = data.qpos[scene.qpos_at : scene.qpos_at + 7]
        self._prefix, self._own = scene.prefix, set(scene.geoms())
        self._obstacles: dict[int, ContactKind] = {
            geom: kind
            for body, kind in KIND_OF_BODY.items()
            for geom in np.flatnonzero(model.geom_bodyid == model.body(body).id).tolist()
        }
        people = np.flatnonzero(model.body_mocapid[model.geom_bodyid] >= 0).tolist()
        self._obstacles |= dict.fromkeys((*people, *scene.others()), "hazard")
        self._whose = {geom: other for other in others for geom in other.geoms()}
        self._ground = set(np.flatnonzero(model.geom_bodyid == 0).tolist())  # terrain and decks
        self._body = body_geoms(scene)
        self._force = np.zeros(6)
        self.begin()

    def begin(self, ticks: int = 1) -> None:
        """Forgets what was touched so far; so many clock ticks follow, the first of them is shown."""
        self._ticks: list[dict[ContactKind, Touch]] = [{} for _ in range(ticks)]
        self.show(0)

    def show(self, tick: int) -> None:
        """Turns to a tick, from 0."""
        self.strongest = self._ticks[tick]

    def look(self) -> None:
        """Takes a step of the present tick in which something was touched into account."""
        for index, (one, other) in enumerate(self._data.contact.geom.tolist()):
            part, thing = (one, other) if one in self._own else (other, one)
            if part not in self._own:
                continue  # another rover's
            kind = self._obstacles.get(thing) or ("scrape" if part in self._body else None)
            if kind is None:
                continue  # a wheel on the ground
            mujoco.mj_contactForce(self._model, self._data, index, self._force)
            force = float(self._force[0])
            position, pose = self._data.contact.pos[index].tolist(), self._pose.tolist()
            self.note(kind, Touch(force, part, thing, position, pose))

    def note(self, kind: ContactKind, touch: Touch) -> None:
        """Keeps a touch if none of its kind was stronger."""
        before = self.strongest.get(kind)
        if before is None or touch.force > before.force:
            self.strongest[kind] = touch

    def name_of(self, geom: int) -> str:
        """Returns what a part, an obstacle, another rover's part or the ground is called."""
        if geom in self._ground:
            return "ground"
        name: str = self._model.geom(geom).name or self._model.body(self._model.geom_bodyid[geom]).name
        if (whose := self._whose.get(geom)) is not None:
            return f"{whose.name}/{name.removeprefix(whose.prefix).removeprefix(BODY_PREFIX)}"
        return name.removeprefix(self._prefix).removeprefix(BODY_PREFIX)
