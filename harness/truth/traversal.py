"""What only the simulator knows of a drive: contact events, and totals over an episode."""

from dataclasses import dataclass

from harness.samples import ContactKind, Vector3


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """Contacts of one kind, none of them more than half a second after the one before."""

    # with what: any part with a hazard, any part with a rock, or the body (all but the wheels)
    # with the ground, which is a scrape
    kind: ContactKind
    # start of the clock tick in which it began; `end_ns` is the end of that in which it ended, so
    # that no event is shorter than a tick
    start_ns: int
    end_ns: int
    part: str  # which part of the rover, as its model names it, e.g. "wheel_FL", "chassis"
    other: str  # name of the obstacle in the model, e.g. "hazard_3", or "ground"
    # largest normal force at one contact point in one physics step [N]; `part`, `other` and
    # `point` are those of that moment
    force: float
    point: Vector3  # where on the rover, in its model frame [m]


@dataclass(frozen=True, slots=True)
class Truth:
    """Totals from the start of the episode."""

    time_ns: int = 0  # simulation time that they cover
    path_length: float = 0.0  # length of the model frame's path in three dimensions [m]
    position: Vector3 = (0.0, 0.0, 0.0)  # where that frame is now [m]
    hazard_contacts: int = 0  # contact events of any rover part with a hazard
    rock_contacts: int = 0  # contact events of any rover part with a rock
    scrapes: int = 0  # contact events of the body with the ground
    hazard_contact_s: float = 0.0  # time in contact with a hazard [s]
    rock_contact_s: float = 0.0  # time in contact with a rock [s]
    scrape_s: float = 0.0  # time of scraping [s]
    mean_slip: float = 0.0
    # mean magnitude of each wheel's slip ratio, over the times at which its rim or its centre
    # moves at 0.05 m/s or more, 0..1, at 20 Hz; `mean_slip` is that over all wheels
    wheel_slip: tuple[float, ...] = ()
    largest_tilt: float = 0.0  # largest angle between the rover's and the world's vertical [rad]
    tipped_over: bool = False  # the rover has lain on its side or roof
    resets: int = 0  # how often it was put back to its start; the way back is not in `path_length`
