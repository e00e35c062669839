"""A battery against the power of its motors, integrated from raw states; its end; its messages."""

from collections.abc import Iterator

import pytest

from harness.base.errors import RunFailed
from harness.base.sim_time import NANOSECONDS
from harness.episode.episode import Episode
from harness.robots import ROVERS
from harness.sensors.battery import Battery
from harness.spec.run import Run
from harness.spec.sensor import parse_choice

HUSKY = ROVERS["husky"]


def batteries(episode: Episode) -> Iterator[Battery]:
    for batch in episode.batches():
        for tick in batch.ticks:
            yield from (sample for sample in tick.samples if isinstance(sample, Battery))


def driven(**fields: object) -> Episode:
    run = Run.of(robot="husky", terrain="flat", actuators="real", driver="spin", duration=6.0, **fields)
    return Episode(run.but(rovers=(run.rover.but(sensors=(parse_choice("battery"),)),)))


def test_energy_is_what_motors_and_standby_take_and_charge_what_is_left() -> None:
    pack = HUSKY.battery
    assert pack is not None
    readings = list(batteries(driven()))
    last = readings[-1]
    assert last.energy > 1.5 * pack.standby * 6 / 3600
    assert last.percentage == pytest.approx(1 - last.energy / pack.capacity)
    assert last.charge * pack.nominal == pytest.approx(pack.capacity - last.energy)
    assert pack.empty < last.voltage < pack.full
    assert last.current < 0.0 < min(last.motor_currents)
    power = -last.voltage * last.current
    assert power == pytest.approx(3600 * (last.energy - readings[-2].energy) / 0.1, rel=1e-5)


def test_a_run_ends_when_its_battery_is_empty_if_that_is_asked_for() -> None:
    """Standing still: the standby power alone takes the 10 mW h of a battery that is half full in 1.8 s.

    A hair less is in it, so that no rounding decides at which tick.
    """
    entry = {"kind": "battery", "capacity": 0.01998, "charge": 0.5, "ends_run": True}
    rover = HUSKY.but(sensors=(entry,))
    assert rover.battery is not None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("harness.episode.assembly.find_rover", lambda _: rover)
        run = Run.of(robot="husky", terrain="flat", actuators="real", driver="cmd_vel", duration=6.0)
        episode, told = Episode(run), list[Battery]()
        with pytest.raises(RunFailed, match=r"battery is empty at t = 1\.8"):
            told.extend(batteries(episode))
    assert episode.simulation.time_ns / NANOSECONDS == pytest.approx(1.8, abs=0.02)
    used = [battery.energy for battery in told]
    assert used == pytest.approx([rover.battery.standby * b.stamp_ns / NANOSECONDS / 3600 for b in told])
    assert [b.percentage for b in told] == pytest.approx([0.5 - one / 0.01998 for one in used], abs=1e-6)
