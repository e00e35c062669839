"""What all faults have in common, and each sensor's place in a tick."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.base.sim_time import TICK_NS as TICK
from harness.faults.injector import FaultInjector
from harness.faults.lookup import faults_of, sensors
from harness.samples import Imu, LaserScan, Tick, TruthState
from harness.sensors import table
from tests.harness.faults.faulty_ticks import ROWS, imus, made, readings, said, sent, tick
from tests.support.words import parse_faults

SENSORS = {name: row.source for name, row in table.by_fault_name(ROWS).items()}


def test_without_faults_a_tick_passes_as_it_is() -> None:
    one = tick(7)
    assert FaultInjector((), seed=0).corrupt(one) is one


@pytest.mark.parametrize("sensor", sensors())
def test_every_fault_of_every_sensor_changes_what_is_sent_in_its_time_and_nothing_before(
    sensor: str,
) -> None:
    clean = [said(one) for one in sent(seconds=0.4)]
    for name, kind in faults_of(sensor).items():
        value = "" if kind.takes is None or kind.takes.default is not None else "=0.4"
        value = "=5" if name in ("beams", "rate") else value
        faulty = [said(one) for one in sent(f"{sensor}:{name}{value}@0.2", seconds=0.4)]
        assert faulty[:19] == clean[:19], name
        assert faulty[19:] != clean[19:], name


@pytest.mark.parametrize("sensor", SENSORS)
def test_fault_touches_its_sensor_only(sensor: str) -> None:
    first = "zero" if "zero" in faults_of(sensor) else "freeze"
    faults = (f"{sensor}:{first}@0.1+0.1", f"{sensor}:dropout@0.2+0.1")
    clean, faulty = sent(seconds=0.4), sent(*faults, seconds=0.4)
    for kind in set(SENSORS.values()) - {SENSORS[sensor]}:
        assert said(Tick(0, tuple(readings(faulty, kind)))) == said(
            Tick(0, tuple(readings(clean, kind)))
        )


@pytest.mark.parametrize(("seed", "clock_seed"), [(0, None), (3, None), (3, 0), (3, 5)])
def test_each_fault_has_a_random_stream_of_its_own(seed: int, clock_seed: int | None) -> None:
    """The streams are part of what a seed means: numpy's for the key (11, place of the fault)."""
    specs = ("imu:dropout=0.5", "scan:dropout=0.5", "clock:dropout=0.25", "clock:dropout=0.125")
    injector = FaultInjector(parse_faults(specs), seed, ROWS, clock_seed)
    assert injector.disturbs_time
    told = [injector.corrupt(tick(number)) for number in range(1, 201)]
    sent_at = (
        [any(type(s) is Imu for s in one.samples) for one in told],
        [any(type(s) is LaserScan for s in one.samples) for one in told],
        [one.tells_time for one in told],
    )
    kept = []
    for place, share in enumerate((0.5, 0.5, 0.25, 0.125)):
        drawn = clock_seed if place >= 2 and clock_seed is not None else seed
        rng = np.random.default_rng(np.random.SeedSequence(drawn, spawn_key=(11, place)))
        kept.append(rng.random(len(told)) >= share)
    np.testing.assert_array_equal(sent_at, [kept[0], kept[1], kept[2] & kept[3]])


def test_no_fault_changes_the_truth() -> None:
    state = TruthState(TICK, True, False, True, 5.0, 0.1, 0.2, (0.0, 0.1, 0.2, 0.3), 0.01)
    some = ("nan", "dropout", "freeze")
    faults = [f"{sensor}:{kind}" for sensor in SENSORS for kind in some if kind in faults_of(sensor)]
    injector = FaultInjector(parse_faults([*faults, "clock:jump=10@0.01"]), seed=0)
    clean = tick(1)
    assert injector.corrupt(replace(clean, samples=(*clean.samples, state))).samples[-1] is state


@pytest.mark.parametrize("name", ["mast", "mast_2"])
def test_a_sensor_is_not_the_one_whose_name_begins_like_its_own(name: str) -> None:
    (row,) = (row for row in ROWS if row.fault == "barometer")
    assert row.given is not None
    rows = [replace(row, fault=n, given=row.given.but(name=n)) for n in ("mast", "mast_2")]
    samples = {str(one.fault): made(one, TICK, 1.0) for one in rows}
    injector = FaultInjector(parse_faults([f"{name}:dropout"], rows), 0, rows)
    told = injector.corrupt(Tick(TICK, tuple(samples.values()))).samples
    assert told == tuple(sample for other, sample in samples.items() if other != name)


def test_faults_of_one_sensor_act_in_the_order_given() -> None:
    assert imus("imu:stuck=2", "imu:nan@0")[0].linear_acceleration == pytest.approx(
        (math.nan,) * 3, nan_ok=True
    )
    assert imus("imu:nan@0", "imu:stuck=2")[0].linear_acceleration == (2.0, 2.0, 2.0)
