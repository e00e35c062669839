"""A message that is filled again and again: as bytes, of which only stamp and numbers change.

rclpy serialises a wrongly typed value as garbage without a word, so every field gets exactly its type.
"""

from array import array
from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from operator import attrgetter
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Quaternion, Vector3
from rclpy.serialization import serialize_message

from harness import samples
from harness.base.sim_time import NANOSECONDS
from harness.ros.cdr import LITTLE_ENDIAN, Template, places, type_name, without_padding
from harness.ros.channel import Fill, Message, set_stamp

STAMPS = ("header.stamp", "clock")
Numbers = Callable[[Any], Sequence[Any]]  # of a sample


def refilled(message: Message, sources: Mapping[str, Callable[[Any], Any]]) -> Fill:
    """Returns a filler of the stamp, if there is one, and of fields.

    Args:
        message: What does not change of it is filled in.
        sources: What gives a field's value of a sample, by the field's path: a number, a vector, a
            quaternion or a list of numbers.
    """
    stamps = [path for path in STAMPS if hasattr(message, path.partition(".")[0])]
    setters = [(_setter(message, path), value_of) for path, value_of in sources.items()]
    numbers_of = [_stamp for _ in stamps] + [_numbers(message, *source) for source in sources.items()]
    template: Template | None = None

    def fill(sample: Any) -> Message:  # noqa: ANN401 - the kind of sample that the topic has
        nonlocal template
        numbers = [each(sample) for each in numbers_of]
        if template is not None and template.fits(numbers):
            return template.filled(numbers)
        for path in stamps:
            set_stamp(attrgetter(path)(message), sample.stamp_ns)
        for put, value_of in setters:
            put(value_of(sample))
        template = _template(message, [*stamps, *sources])
        return message if template is None else template.filled(numbers)

    return fill


def _template(message: Message, paths: Sequence[str]) -> Template | None:
    """The message as bytes; None where the middleware serialises in another way."""
    kind = type_name(type(message))
    data, found = serialize_message(message), places(message, kind)
    if data[:2] != LITTLE_ENDIAN or not 0 <= len(data) - found[""].start < 16:
        return None
    return Template(without_padding(data, kind, None), [found[path] for path in paths])


def _stamp(sample: samples.Sample) -> tuple[int, int]:
    return divmod(sample.stamp_ns, NANOSECONDS)


def _numbers(message: Message, path: str, value_of: Callable[[Any], Any]) -> Numbers:
    """What gives the numbers of a field of a sample."""
    kind = type(reduce(_step, path.split("."), message))
    return (lambda sample: (kind(value_of(sample)),)) if kind in {bool, float, int} else value_of


def _step(owner: Any, step: str) -> Any:  # noqa: ANN401 - a field, or an element of one
    name, _, index = step.rstrip("]").partition("[")
    return getattr(owner, name)[int(index)] if index else getattr(owner, name)


def _setter(message: Message, path: str) -> Callable[[Any], None]:
    """What sets a field that is a vector, a quaternion, an array or a plain value."""
    *parents, name = path.split(".")
    owner = reduce(_step, parents, message)
    present = getattr(owner, name)
    if isinstance(present, Vector3 | Point):
        return partial(_set_vector, present)
    if isinstance(present, Quaternion):
        return partial(_set_quaternion, present)
    if isinstance(present, array):
        return lambda value: setattr(owner, name, array(present.typecode, value))
    if isinstance(present, np.ndarray):
        return lambda value: setattr(owner, name, np.asarray(value, present.dtype))
    return lambda value: setattr(owner, name, type(present)(value))


def _set_vector(target: Vector3 | Point, value: samples.Vector3) -> None:
    target.x, target.y, target.z = value


def _set_quaternion(target: Quaternion, value: samples.Quaternion) -> None:
    target.x, target.y, target.z, target.w = value
