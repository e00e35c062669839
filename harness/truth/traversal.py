"""What only the simulator knows of a drive: contact events, and totals over an episode."""

from harness.samples import ContactKind, Vector3, plain_value


@plain_value
class ContactEvent:
    """Contacts of one kind, none of them more than half a second after the one before.

    Attributes:
        kind: With what: any part with a hazard, any part with a rock, or the body (all but the
            wheels) with the ground, which is a scrape.
        start_ns: Start of the clock tick in which it began; `end_ns` is the end of that in which it
            ended, so that no event is shorter than a tick.
        part: Which part of the rover, as its model names it, e.g. "wheel_FL", "chassis".
        other: Name of the obstacle in the model, e.g. "hazard_3", or "ground".
        force: Largest normal force at one contact point in one physics step [N]; `part`, `other` and
            `point` are those of that moment.
        point: Where on the rover, in its model frame [m].
    """

    kind: ContactKind
    start_ns: int
    end_ns: int
    part: str
    other: str
    force: float
    point: Vector3


@plain_value
class Truth:
    """Totals from the start of the episode.

    Attributes:
        time_ns: Simulation time that they cover.
        path_length: Length of the model frame's path in three dimensions [m].
        position: Where that frame is now [m].
        hazard_contacts: Contact events of any rover part with a hazard.
        rock_contacts: Contact events of any rover part with a rock.
        scrapes: Contact events of the body with the ground.
        hazard_contact_s: Time in contact with a hazard [s].
        rock_contact_s: Time in contact with a rock [s].
        scrape_s: Time of scraping [s].
        wheel_slip: Mean magnitude of each wheel's slip ratio, over the times at which its rim or
            its centre moves at 0.05 m/s or more, 0..1, at 20 Hz; `mean_slip` is that over all wheels.
        largest_tilt: Largest angle between the rover's and the world's vertical [rad].
        tipped_over: The rover has lain on its side or roof.
        resets: How often it was put back to its start; the way back is not in `path_length`.
    """

    time_ns: int = 0
    path_length: float = 0.0
    position: Vector3 = (0.0, 0.0, 0.0)
    hazard_contacts: int = 0
    rock_contacts: int = 0
    scrapes: int = 0
    hazard_contact_s: float = 0.0
    rock_contact_s: float = 0.0
    scrape_s: float = 0.0
    mean_slip: float = 0.0
    wheel_slip: tuple[float, ...] = ()
    largest_tilt: float = 0.0
    tipped_over: bool = False
    resets: int = 0
