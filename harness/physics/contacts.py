"""What rovers touch, step by step: the strongest contact of each kind in a clock tick.

MuJoCo's contacts are walked only in steps whose contact counts are not zero; the counts are those of the
truth sensors of harness.physics.scene.
"""

import ctypes
from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from harness.physics.c_functions import addresses
from harness.physics.scene import HAZARD_CONTACT, ROCK_CONTACT, SCRAPE_CONTACT, Scene, body_geoms
from harness.physics.stepping_record import FOUND, SPAN, Contacts
from harness.physics.steps_kernel import BODY, HAZARD, ROCK, WHEEL, look
from harness.samples import ContactKind

COUNTED = ROCK_CONTACT, HAZARD_CONTACT, SCRAPE_CONTACT
BODY_PREFIX = "body_"  # of the names of geoms that are not wheels, in the models that ship
KIND_OF_BODY = {"rocks": ROCK, "hazards": HAZARD}
KINDS: tuple[ContactKind, ...] = ("hazard", "rock", "scrape")


class Touch(NamedTuple):
    """One contact point in one physics step."""

    force: float  # along the normal [N]
    part: int  # geom of the rover
    other: int  # geom of the obstacle, the other rover or the ground
    position: list[float]  # in the world [m]
    pose: list[float]  # the rover's then: position [m] and w, x, y, z


class ContactWatch:
    """Watches all rovers of a world; `look` after a step whose counts are not all zero.

    Args:
        scenes: Of the rovers.
        data: Their state.

    Attributes:
        rovers: What each of them touches.
        contacts: MuJoCo's contacts, as `steps_kernel` takes them; none until `look` found them.
        watched: What is looked for, as `steps_kernel` takes it.
    """

    def __init__(self, scenes: Sequence[Scene], data: mujoco.MjData) -> None:
        self._model, self._data = model, _ = scenes[0].model, data
        counts = [
            [at for name, at in scene.sensors().items() if name.startswith(COUNTED)] for scene in scenes
        ]
        ends = [(own[0].start, own[-1].stop) for own in counts]  # one next to the other
        kinds = np.zeros((len(scenes), model.ngeom), np.int8)
        for scene, row in zip(scenes, kinds, strict=True):
            for body, kind in KIND_OF_BODY.items():
                row[model.geom_bodyid == model.body(body).id] = kind
            row[model.body_mocapid[model.geom_bodyid] >= 0] = HAZARD
            row[scene.others()] = HAZARD
            row[scene.geoms()] = WHEEL
            row[list(body_geoms(scene))] = BODY
        poses = np.array([scene.qpos_at for scene in scenes])
        strongest = np.zeros((len(scenes), SPAN, len(KINDS), FOUND))
        self._all = np.array(ends), kinds, poses, strongest
        self._none = np.zeros((0, 2), int), kinds, poses, strongest
        unknown = np.zeros(1, np.int32), np.zeros((0, 1)), np.zeros((0, 1), np.int32), np.zeros(2, int)
        self.contacts: Contacts = unknown
        self.rovers = tuple(RoverContacts(number, scenes, rows) for number, rows in enumerate(strongest))

        self.begin()

    def begin(self, *, watches: bool = True) -> None:
        """Forgets what was touched so far; from now on it watches, or does not."""
        self.watched = self._all if watches else self._none
        self._all[-1][..., 0] = 0.0
        for rover in self.rovers:
            rover.strongest = {}

    def take(self, strongest: np.ndarray) -> None:
        """Takes over what was touched in another state of the same model, as `watched` has it."""
        self.watched, self._all[-1][:] = self._all, strongest
        for rover in self.rovers:
            rover.strongest = {}

    @property
    def any(self) -> bool:
        """Whether anything was touched since `begin`."""
        return self.watched is self._all and bool(np.count_nonzero(self._all[-1][..., 0]))

    def are_known(self) -> bool:
        """Returns whether it is known where MuJoCo keeps contacts, which the first one tells."""
        if not self.contacts[1].size and self._data.ncon:  # once
            self.contacts = _contacts(self._data)
        return self.contacts[1].size > 0

    def look(self, tick: int = 0) -> None:
        """Takes a step of a tick in which something was touched into account."""
        self.are_known()
        pointers = addresses()[0], self._model._address, self._data._address  # noqa: SLF001 - no other name
        state = self._data.qpos, self._data.sensordata
        look(pointers, state, self.contacts, self.watched, tick)


class RoverContacts:
    """What one rover touches.

    Args:
        number: The rover's place among those of the world.
        scenes: Of all of them.
        strongest: Its strongest contacts, as `steps_kernel` has them.

    Attributes:
        strongest: The strongest contact of each kind in the tick that is shown.
    """

    def __init__(self, number: int, scenes: Sequence[Scene], strongest: np.ndarray) -> None:
        scene = scenes[number]
        self._model, self._prefix, self._strongest = scene.model, scene.prefix, strongest
        others = [*scenes[:number], *scenes[number + 1 :]]
        self._whose = {geom: other for other in others for geom in other.geoms()}
        # Terrain and decks.
        self._ground = set(np.flatnonzero(scene.model.geom_bodyid == 0).tolist())
        self.strongest: dict[ContactKind, Touch]

    def show(self, tick: int) -> None:
        """Turns to a tick, from 0."""
        rows = self._strongest[tick]
        order = rows[:, 0].tolist()
        if not any(order):
            self.strongest = {}
            return
        touched = sorted((place, kind) for kind, place in enumerate(order) if place)
        self.strongest = {KINDS[kind]: _touch(rows[kind].tolist()) for _, kind in touched}

    def note(self, kind: ContactKind, touch: Touch) -> None:
        """Keeps a touch in the tick that is shown if none of its kind was stronger."""
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


def _touch(row: list[float]) -> Touch:
    _, force, part, other, *rest = row
    return Touch(force, int(part), int(other), rest[:3], rest[3:])


def _contacts(data: mujoco.MjData) -> Contacts:
    """Where MuJoCo keeps its contacts, of which there must be some: at the beginning of its arena.

    Their fields tell place and size of one of them. Their count stands behind the timers.
    """
    first, timers = data.contact, data.timer.duration
    begin, size = first.dist.ctypes.data, first.dist.strides[0]
    count = (ctypes.c_int * 1).from_address(timers.ctypes.data + timers.strides[0] * timers.size)
    if count[0] != data.ncon:
        raise RuntimeError(f"MuJoCo {mujoco.__version__} counts its contacts elsewhere than 4.0 does")
    numbers = data.narena // size * size // 8
    doubles = np.ctypeslib.as_array((ctypes.c_double * numbers).from_address(begin))
    places = (first.pos.ctypes.data - begin) // 8, (first.geom.ctypes.data - begin) // 4
    integers = doubles.view(np.int32).reshape(-1, size // 4)
    return np.ctypeslib.as_array(count), doubles.reshape(-1, size // 8), integers, np.array(places)
