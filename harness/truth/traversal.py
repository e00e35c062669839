"""What only the simulator knows, summed up over an episode: path, contacts, slip, tilt.

Observed once per clock tick from the contact counts of every step, so that no contact between two
sensor samples is missed.
"""

import math
from dataclasses import dataclass

from harness.samples import sent_by_fields

SLIP_SPEED = 0.02  # [m/s]: a wheel and a rover both slower than this do not slip, they stand
TIPPED_OVER = math.radians(75.0)  # between the static tip angles (44-59 deg) and lying on a side


@sent_by_fields
@dataclass(frozen=True, slots=True)
class Truth:
    """Totals from the start of the episode.

    Attributes:
        time_ns: Simulation time that they cover.
        path_length: Length of the model frame's path in three dimensions [m].
        position: Where that frame is now [m].
        hazard_contacts: Contact events of any rover part with a hazard (harness.truth.events);
            likewise `rock_contacts`, and `scrapes` of the body along the ground.
        hazard_contact_s: Time in contact with a hazard [s]; so for rocks and for the body scraping
            the ground.
        wheel_slip: Mean magnitude of each wheel's slip ratio, over the times at which it turns or is
            moved, 0..1, at 20 Hz; `mean_slip` is that over all wheels.
        largest_tilt: Largest angle between the rover's and the world's vertical [rad].
        tipped_over: The rover has lain on its side or roof.
        resets: How often it was put back to its start; the way back is not in `path_length`.
    """

    time_ns: int = 0
    path_length: float = 0.0
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    hazard_contacts: int = 0
    rock_contacts: int = 0
    scrapes: int = 0
    hazard_contact_s: float = 0.0
    rock_contact_s: float = 0.0
    scrape_s: float = 0.0
    mean_slip: float = 0.0
    wheel_slip: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    largest_tilt: float = 0.0
    tipped_over: bool = False
    resets: int = 0


def slip_ratio(wheel_speed: float, ground_speed: float) -> float:
    """Longitudinal slip in -1..1: positive when driving, negative when braking, 0 at rest.

    (w r - v) / max(|w r|, |v|), the two-sided form of Wong, Theory of Ground Vehicles, section 1.3; a
    wheel that turns against its motion slips fully, it cannot do more.

    Args:
        wheel_speed: Circumferential speed of the wheel [m/s].
        ground_speed: Speed of the wheel's centre along its heading [m/s].
    """
    reference = max(abs(wheel_speed), abs(ground_speed))
    if reference < SLIP_SPEED:
        return 0.0
    return max(-1.0, min(1.0, (wheel_speed - ground_speed) / reference))
