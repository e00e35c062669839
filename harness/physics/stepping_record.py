"""What is stepped, as compiled code takes it: a record whose address stands for all of its arrays."""

from harness.base.passing import doubles, integers, integers8, integers32, layout, pointer, reader

# isort: split
import numba
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined
from harness.base.sim_time import TICKS_PER_CONTROL
from harness.physics.passed_over import PassedOver

SPAN = TICKS_PER_CONTROL  # clock ticks that are simulated in one go, at most
KINDS_OF_CONTACT, FOUND = 3, 14  # rows and numbers of the strongest contacts: see `Watched`

Doubles = NDArray[np.float64]
Integers = NDArray[np.int64]
Pointers = tuple[int, int, int, int, int, int]
# Which sensor values are counts of contacts, (rovers, 2): from and to; what each geom is to each rover,
# (rovers, geoms); where the rovers' poses stand in qpos, (rovers,); the strongest contact of each kind,
# (rovers, SPAN, 3, FOUND): its place in the order of the kinds' first ones, 0 for none, then normal
# force [N], geoms of the rover and of the other, position [m] and pose of the rover.
Watched = tuple[Integers, NDArray[np.int8], Integers, Doubles]
# MuJoCo's own: count of contacts, contacts as rows of numbers and of integers, where in a row the
# position stands and the geoms do.
Contacts = tuple[NDArray[np.int32], Doubles, NDArray[np.int32], Integers]

STATE = ("qpos", "qvel", "qfrc_actuator")  # what of MuJoCo's is recorded at the end of a tick
BITS = ("geom_contype", "geom_conaffinity", "body_contype", "body_conaffinity")
OWN = (
    "pointers",  # addresses of mj_contactForce, mj_step, mj_step1, mj_step2, of the model and its data
    *("controls", "motors", "commands"),  # those that are commanded, and to what, (ticks, motors)
    *("counters", "fence"),  # of warnings, the last one and how many of each; as `Span` has it
    *("sensors", "sums"),  # values, and where their sums over a tick's steps come, (ticks, sensors)
    *STATE,
    *(f"{name} of ticks" for name in STATE),  # where it comes, each (ticks, ...)
    *("discs", "obstacles", "bodies", *BITS, "rovers", "reach"),  # see `PassedOver`
)
CONTACTS = (
    *("count", "numbers", "integers", "places"),  # see `Contacts`
    *("counts", "kinds", "poses", "strongest"),  # see `Watched`
)
STEPPING = layout((*OWN, *CONTACTS))

# What `steps_kernel.advance` takes, as integers: the address of a record; where to begin and to end,
# counted from the first tick's first step; steps of a tick; 1 after `begin_step`, else 0. Then where it
# ended, counted alike; negative after a touch before contacts are known.
RECORD, BEGIN, END, PER_TICK, IS_BEGUN, ENDED = range(6)

_passed = reader(STEPPING)


@inlined
def _row(of: Integers) -> Doubles:
    return doubles(of).ravel()


@inlined
def _bits(of: Integers) -> NDArray[np.int32]:
    return integers32(of).ravel()


@inlined
def _strongest(of: Integers) -> Doubles:
    strongest: Doubles = numba.carray(pointer(of[0]), (of[1], SPAN, KINDS_OF_CONTACT, FOUND), np.float64)
    return strongest


@inlined
def obstacles_at(address: int) -> PassedOver:
    """Returns the obstacles of the record at an address."""
    of = _passed(address)
    return (
        doubles(of["discs"]),
        integers32(of["obstacles"]),
        integers32(of["bodies"]),
        (
            _bits(of["geom_contype"]),
            _bits(of["geom_conaffinity"]),
            _bits(of["body_contype"]),
            _bits(of["body_conaffinity"]),
        ),
        integers(of["rovers"]),
        _row(of["reach"]),
    )


@inlined
def contacts_at(address: int) -> tuple[Contacts, Watched]:
    """Returns the contacts of the record at an address, and what is watched of them."""
    of = _passed(address)
    return (
        (
            _bits(of["count"]),
            doubles(of["numbers"]),
            integers32(of["integers"]),
            integers(of["places"]).ravel(),
        ),
        (
            integers(of["counts"]),
            integers8(of["kinds"]),
            integers(of["poses"]).ravel(),
            _strongest(of["strongest"]),
        ),
    )


@inlined
def pointers_at(address: int) -> Pointers:
    """Returns the addresses of MuJoCo's functions, model and data in the record at an address."""
    p = integers(_passed(address)["pointers"]).ravel()
    return p[0], p[1], p[2], p[3], p[4], p[5]


@inlined
def health_at(address: int) -> tuple[NDArray[np.int32], Doubles]:
    """Returns the warnings counted in the record at an address, of each kind, and the rovers' fences."""
    of = _passed(address)
    return integers32(of["counters"])[:, 1], doubles(of["fence"])


@inlined
def state_at(address: int) -> tuple[Doubles, Doubles, Doubles]:
    """Returns positions, velocities and actuator forces in the record at an address."""
    of = _passed(address)
    return _row(of["qpos"]), _row(of["qvel"]), _row(of["qfrc_actuator"])


@inlined
def ticks_at(address: int) -> tuple[Doubles, Doubles, Doubles]:
    """Returns where STATE goes at the end of each tick, (ticks, n), in the record at an address."""
    of = _passed(address)
    return (
        doubles(of["qpos of ticks"]),
        doubles(of["qvel of ticks"]),
        doubles(of["qfrc_actuator of ticks"]),
    )


@inlined
def motors_at(address: int) -> tuple[Doubles, Integers, Doubles]:
    """Returns controls in the record at an address, which of them are commanded, and to what."""
    of = _passed(address)
    return _row(of["controls"]), integers(of["motors"]).ravel(), doubles(of["commands"])


@inlined
def felt_at(address: int) -> tuple[Doubles, Doubles]:
    """Returns sensor values in the record at an address, and where their sums come."""
    of = _passed(address)
    return _row(of["sensors"]), doubles(of["sums"])
