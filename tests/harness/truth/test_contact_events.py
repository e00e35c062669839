from harness.base.sim_time import TICK_NS
from harness.physics.contacts import Touch
from harness.samples import ContactKind
from harness.truth.contact_events import ContactEvents
from rover_metrics.timing import EVENT_GAP_NS

GAP_TICKS = EVENT_GAP_NS // TICK_NS
TURNED_LEFT = [0.5**0.5, 0.0, 0.0, 0.5**0.5]


def touch(force: float, part: int = 1, position: tuple[float, ...] = (1.0, 2.0, 0.5)) -> Touch:
    return Touch(force, part, 7, list(position), [1.0, 2.0, 0.1, *TURNED_LEFT])


def observe(events: ContactEvents, *ticks: tuple[int, dict[ContactKind, Touch]]) -> None:
    for tick, strongest in ticks:
        events.observe(tick * TICK_NS, strongest)


def watched() -> ContactEvents:
    return ContactEvents({1: "wheel_FL", 2: "chassis", 7: "hazard_0"}.__getitem__)


def test_contacts_up_to_the_gap_apart_are_one_event_and_farther_ones_are_two() -> None:
    events = watched()
    first, last = 10, 10 + GAP_TICKS
    observe(events, (first, {"hazard": touch(1.0)}), (last, {"hazard": touch(1.0)}))
    observe(events, (last + GAP_TICKS, {}))
    assert events.take_closed() == ()
    assert len(events.open) == 1
    observe(events, (last + GAP_TICKS + 1, {"hazard": touch(1.0)}))
    (event,) = events.take_closed()
    assert (event.start_ns, event.end_ns) == ((first - 1) * TICK_NS, last * TICK_NS)
    assert events.begun == {"hazard": 2, "rock": 0, "scrape": 0}
    assert events.take_closed() == ()
    observe(events, (last + 2 * GAP_TICKS + 2, {}))
    assert len(events.take_closed()) == 1, "although nothing is touched any more"


def test_an_event_names_its_strongest_contact_and_where_on_the_rover_it_was() -> None:
    events = watched()
    observe(
        events,
        (1, {"hazard": touch(5.0, part=1)}),
        (2, {"hazard": touch(80.0, part=2, position=(1.2, 1.9, 0.4))}),
        (3, {"hazard": touch(20.0, part=1)}),
    )
    events.close()
    (event,) = events.take_closed()
    assert (event.force, event.part, event.other) == (80.0, "chassis", "hazard_0")
    assert [round(value, 9) for value in event.point] == [-0.1, -0.2, 0.3]
    assert (event.start_ns, event.end_ns) == (0, 3 * TICK_NS)
