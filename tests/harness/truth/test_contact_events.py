from harness.base.sim_time import TICK_NS
from harness.physics.contacts import Touch
from harness.samples import ContactKind
from harness.truth.contact_events import ContactEvents
from rover_metrics.timing import EVENT_GAP_NS

GAP_TICKS = EVENT_GAP_NS // TICK_NS


TOUCH = Touch(1.0, 1, 7, [1.0, 2.0, 0.5], [1.0, 2.0, 0.1, 1.0, 0.0, 0.0, 0.0])


def observe(events: ContactEvents, *ticks: tuple[int, dict[ContactKind, Touch]]) -> None:
    for tick, strongest in ticks:
        events.observe(tick * TICK_NS, strongest)


def test_contacts_up_to_the_gap_apart_are_one_event_and_farther_ones_are_two() -> None:
    events = ContactEvents({1: "wheel_FL", 7: "hazard_0"}.__getitem__)
    first, last = 10, 10 + GAP_TICKS
    observe(events, (first, {"hazard": TOUCH}), (last, {"hazard": TOUCH}))
    observe(events, (last + GAP_TICKS, {}))
    assert events.take_closed() == ()
    assert len(events.open) == 1
    observe(events, (last + GAP_TICKS + 1, {"hazard": TOUCH}))
    (event,) = events.take_closed()
    assert (event.start_ns, event.end_ns) == ((first - 1) * TICK_NS, last * TICK_NS)
    assert events.begun == {"hazard": 2, "rock": 0, "scrape": 0}
    assert events.take_closed() == ()
    observe(events, (last + 2 * GAP_TICKS + 2, {}))
    assert len(events.take_closed()) == 1, "although nothing is touched any more"
