"""Steps of MuJoCo one after the other in one compiled call, which leaves the interpreter to others.

Between two steps nobody needs Python: what the ends of the clock ticks looked like is recorded, and of
what was touched in a tick the strongest contact of each kind.
"""

import ctypes

import numba
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel, native
from harness.base.passing import pointer
from harness.physics.passed_over import pass_over, restore
from harness.physics.stepping_record import (
    ENDED,
    Contacts,
    Doubles,
    Integers,
    Watched,
    contacts_at,
    felt_at,
    health_at,
    motors_at,
    obstacles_at,
    pointers_at,
    state_at,
    ticks_at,
)

WHEEL, BODY, ROCK, HAZARD = 1, 2, 3, 4  # what a geom is to a rover; 0: ground

_step = native(ctypes.c_void_p, ctypes.c_void_p)
_contact_force = native(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)


@inlined
def _begin_tick(control: tuple[Doubles, Integers, Doubles], tick: int) -> None:
    controls, motors, commands = control
    for place in range(motors.size):
        controls[motors[place]] = commands[tick, place]


@inlined
def _kind(mine: int, other: int) -> int:
    """Hazard, rock or scrape, counted from 0, by what the two geoms of a contact are; -1 for none."""
    if other == HAZARD:
        return 0
    if other == ROCK:
        return 1
    return 2 if mine == BODY else -1


@inlined
def _look(
    pointers: tuple[int, int, int],
    qpos: Doubles,
    contacts: Contacts,
    watched: Watched,
    at: tuple[int, int],
) -> None:
    """Takes the contacts of a rover in the present step, which belongs to a tick, into account."""
    (count, doubles, integers, places), (_, kinds, poses, strongest), (rover, tick) = (
        contacts,
        watched,
        at,
    )
    force = np.empty(6)
    for contact in range(count[0]):
        part, thing = integers[contact, places[1]], integers[contact, places[1] + 1]
        if kinds[rover, part] != WHEEL and kinds[rover, part] != BODY:
            part, thing = thing, part
            if kinds[rover, part] != WHEEL and kinds[rover, part] != BODY:
                continue  # another rover's
        kind = _kind(kinds[rover, part], kinds[rover, thing])
        if kind < 0:
            continue  # a wheel on the ground
        _contact_force(pointers[0], (pointers[1], pointers[2], contact, force.ctypes.data))
        row = strongest[rover, tick, kind]
        if row[0] == 0.0:
            row[0] = 1.0 + np.count_nonzero(strongest[rover, tick, :, 0])
        elif force[0] <= row[1]:
            continue
        row[1], row[2], row[3] = force[0], part, thing
        row[4:7] = doubles[contact, places[0] : places[0] + 3]
        row[7:] = qpos[poses[rover] : poses[rover] + 7]


@kernel(
    "boolean(UniTuple(int64, 3), UniTuple(float64[::1], 2),"
    "Tuple((int32[::1], float64[:,::1], int32[:,::1], int64[::1])),"
    "Tuple((int64[:,::1], int8[:,::1], int64[::1], float64[:,:,:,::1])), int64)"
)
def look(
    pointers: tuple[int, int, int],
    state: tuple[Doubles, Doubles],
    contacts: Contacts,
    watched: Watched,
    tick: int,
) -> bool:
    """Takes the contacts of the present step into account, those of rovers that touch something.

    Args:
        pointers: Addresses of mj_contactForce, of the model and of its data.
        state: The data's positions and its sensor values.
        contacts: Its contacts; none as long as nobody knows where they are.
        watched: What is looked for, and where the strongest of a kind comes.
        tick: To which they belong.

    Returns:
        Whether a rover touches something.
    """
    counts, touches = watched[0], False
    for rover in range(counts.shape[0]):
        if np.any(state[1][counts[rover, 0] : counts[rover, 1]]):
            touches = True
            if contacts[1].size:
                _look(pointers, state[0], contacts, watched, (rover, tick))
    return touches


@inlined
def _is_wrong(health: tuple[NDArray[np.int32], Doubles], qpos: Doubles) -> bool:
    warnings, fence = health
    for rover in range(fence.shape[0]):
        at = int(fence[rover, 0])
        x, y = qpos[at], qpos[at + 1]
        if not (fence[rover, 1] < x < fence[rover, 2] and fence[rover, 3] < y < fence[rover, 4]):
            return True
    return bool(np.any(warnings))


@kernel("boolean(int64)")
def is_wrong(stepping: int) -> bool:
    """Returns whether there are warnings, or a rover left its fence; takes the address of a record."""
    return _is_wrong(health_at(stepping), state_at(stepping)[0])


@kernel("void(int64)")
def advance(steps: int) -> None:
    """Steps to the end, or until something is wrong after a tick, or a touch before contacts are known.

    Args:
        steps: Address of integers in the order of `stepping_record.RECORD` and what follows it.
    """
    row = numba.carray(pointer(steps), ENDED + 1, np.int64)
    stepping, begin, end, per_tick, is_begun = row[0], row[1], row[2], row[3], row[4]
    (force, step_whole, _, step_second, model, data), ended = pointers_at(stepping), end
    control, health, (sensors, sums) = motors_at(stepping), health_at(stepping), felt_at(stepping)
    state, record, obstacles = state_at(stepping), ticks_at(stepping), obstacles_at(stepping)
    contacts, watched = contacts_at(stepping)
    if not is_begun:
        pass_over(obstacles, state[0], state[1])
    for step in range(begin, end):
        tick, within = step // per_tick, step % per_tick
        if within == 0:
            _begin_tick(control, tick)
            sums[tick] = 0.0
        _step(step_second if is_begun and step == begin else step_whole, (model, data))
        sums[tick] += sensors
        touches = look((force, model, data), (state[0], sensors), contacts, watched, tick)
        is_last = within == per_tick - 1
        if is_last:
            for part in range(len(state)):
                record[part][tick] = state[part]
        if is_last and _is_wrong(health, state[0]):
            ended = step + 1
            break
        if touches and not contacts[1].size:
            ended = -(step + 1)
            break
    restore(obstacles)
    row[ENDED] = ended


@inlined
def begin_step(stepping: int) -> None:
    """Does the half of the next step that needs no commands, mj_step1; `advance` goes on from there.

    Until then the friction of the model must stay as it is, and obstacles that are passed over stay so.
    It takes the address of a record.
    """
    state, pointers = state_at(stepping), pointers_at(stepping)
    pass_over(obstacles_at(stepping), state[0], state[1])
    _step(pointers[2], (pointers[4], pointers[5]))
