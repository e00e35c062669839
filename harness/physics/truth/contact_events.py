"""Contacts, tick by tick -> contact events."""

from collections.abc import Callable
from dataclasses import replace

import mujoco
import numpy as np

from harness.base.sim_time import TICK_NS
from harness.physics.contacts import Touch
from harness.samples import ContactEvent, ContactKind, Vector3
from rover_metrics.timing import EVENT_GAP_NS


class ContactEvents:
    """Joins contacts to events; call `observe` after every clock tick.

    Attributes:
        begun: How many events of each kind there have been.
    """

    def __init__(self, name_of: Callable[[int], str]) -> None:
        self._name_of = name_of
        self._open: dict[ContactKind, ContactEvent] = {}
        self._closed: list[ContactEvent] = []
        self.begun: dict[ContactKind, int] = {"hazard": 0, "rock": 0, "scrape": 0}

    @property
    def open(self) -> tuple[ContactEvent, ...]:
        """Events that a further contact would prolong, as they stand."""
        return tuple(self._open.values())

    def observe(self, time_ns: int, strongest: dict[ContactKind, Touch]) -> None:
        """Takes the tick that ends now, with the strongest contact of each kind in it."""
        if not self._open and not strongest:
            return
        for kind, event in list(self._open.items()):
            if time_ns - event.end_ns > EVENT_GAP_NS:
                self._closed.append(self._open.pop(kind))
        for kind, touch in strongest.items():
            self._take(kind, touch, time_ns)

    def close(self) -> None:
        """Ends all events: the drive is over, or goes on elsewhere."""
        self._closed += self._open.values()
        self._open.clear()

    def take_closed(self) -> tuple[ContactEvent, ...]:
        """Returns the events that have ended since the last call, in that order."""
        closed = tuple(self._closed)
        self._closed.clear()
        return closed

    def _take(self, kind: ContactKind, touch: Touch, time_ns: int) -> None:
        event = self._open.get(kind)
        if event is not None and touch.force <= event.force:
            self._open[kind] = replace(event, end_ns=time_ns)
            return
        if event is None:
            self.begun[kind] += 1
        self._open[kind] = ContactEvent(
            kind=kind,
            start_ns=time_ns - TICK_NS if event is None else event.start_ns,
            end_ns=time_ns,
            part=self._name_of(touch.part),
            other=self._name_of(touch.other),
            force=touch.force,
            point=_in_model_frame(touch),
        )


def _in_model_frame(touch: Touch) -> Vector3:
    point, back = np.array(touch.position) - touch.pose[:3], np.empty(4)
    mujoco.mju_negQuat(back, np.array(touch.pose[3:]))
    mujoco.mju_rotVecQuat(point, point.copy(), back)
    x, y, z = point.tolist()
    return x, y, z
