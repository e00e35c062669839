"""The people of a simulation: mocap bodies, moved once a clock tick, and whether a rover touches one.

They are kinematic: nothing pushes them, and they push the rover only if `push` asks for it. A touch is
truth all the same: it is a contact with a hazard, without a force where nobody pushes.
"""

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from harness.base.sim_time import NANOSECONDS, TICK
from harness.physics.contacts import RoverContacts, Touch
from harness.physics.scene import Scene
from harness.samples import Place, Vector3
from harness.world.actors.social_force import SocialForceWalker

REACH = 0.1  # [m] beyond bounding discs within which a touch is looked for


class Crowd:
    """Moves the people of a world; call `move` before the steps of a tick and `look` after them.

    Args:
        scenes: Of all rovers of the world.
        data: Their state.

    Attributes:
        actors: Who they are.
        places: Where they are now, in that order.
    """

    def __init__(self, scenes: Sequence[Scene], data: mujoco.MjData) -> None:
        scene = scenes[0]
        model = scene.model
        self.actors = scene.world.people
        self._ground, self._model, self._data = scene.world.ground, model, data
        self._ways = [actor.walk() for actor in self.actors]
        self._rovers = [(data.qpos[s.qpos_at : s.qpos_at + 7], s.rover.reach) for s in scenes]
        self._mocap = [int(model.body(actor.name).mocapid[0]) for actor in self.actors]
        self._geoms = [int(model.geom(actor.name).id) for actor in self.actors]
        solid = (model.geom_contype | model.geom_conaffinity) != 0
        self._parts = [[geom for geom in scene.geoms() if solid[geom]] for scene in scenes]
        self.restart(0)

    def restart(self, time_ns: int) -> None:
        """Lets all walks begin anew at a simulation time."""
        self._began_ns = time_ns
        for way in self._ways:
            if isinstance(way, SocialForceWalker):
                way.restart()
        self.places = [Place(*actor.begin, 0.0) for actor in self.actors]
        self.move(time_ns)

    def move(self, time_ns: int) -> None:
        """Puts everybody where they are at a simulation time, a clock tick after the last one."""
        since_s = (time_ns - self._began_ns) / NANOSECONDS
        discs = [(*pose[:2].tolist(), reach) for pose, reach in self._rovers] + [
            (place.x, place.y, actor.spec.options.radius)
            for place, actor in zip(self.places, self.actors, strict=True)
        ]
        seconds, first = TICK if since_s > 0.0 else 0.0, len(self._rovers)
        self.places = [
            way.walk(since_s, seconds, discs[:number] + discs[number + 1 :])
            if isinstance(way, SocialForceWalker)
            else way.place(since_s)
            for number, way in enumerate(self._ways, first)
        ]
        for mocap, position, place in zip(self._mocap, self.positions(), self.places, strict=True):
            self._data.mocap_pos[mocap] = position
            self._data.mocap_quat[mocap] = math.cos(place.yaw / 2), 0.0, 0.0, math.sin(place.yaw / 2)

    def positions(self) -> list[Vector3]:
        """Returns where the middles of the bodies are [m]."""
        return [
            (p.x, p.y, self._ground.height_at(p.x, p.y) + 0.5 * actor.spec.options.height)
            for p, actor in zip(self.places, self.actors, strict=True)
        ]

    def look(self, watches: Sequence[RoverContacts]) -> None:
        """Notes whom each rover overlaps; where people push, MuJoCo's contacts have the force."""
        for number, ((pose, reach), contacts) in enumerate(zip(self._rovers, watches, strict=True)):
            x, y = pose[:2].tolist()
            for geom, place, actor in zip(self._geoms, self.places, self.actors, strict=True):
                gap = math.hypot(place.x - x, place.y - y) - actor.spec.options.radius
                if gap < reach + REACH:
                    self._touch(geom, number, contacts)

    def _touch(self, geom: int, rover: int, contacts: RoverContacts) -> None:
        span = np.zeros(6)
        for part in self._parts[rover]:
            gap = mujoco.mj_geomDistance(self._model, self._data, part, geom, REACH, span)
            if gap <= 0.0:
                middle = (0.5 * (span[:3] + span[3:])).tolist()
                pose = self._rovers[rover][0].tolist()
                contacts.note("hazard", Touch(0.0, part, geom, middle, pose))
                return
