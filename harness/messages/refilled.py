"""A message that is filled again and again: as bytes, of which only stamp and numbers change."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from typing import Any

import numpy as np

from harness import samples
from harness.base.sim_time import NANOSECONDS
from harness.messages.blank import Message, cdr, kind_of
from harness.messages.cdr import Template, places
from rover_metrics.plugins import blamed, misfit

Fill = Callable[[Any], bytes | None]  # a sample of the topic's kind -> its message, or None for none
STAMPS = ("header.stamp", "clock")
AXES = ("x", "y", "z", "w")
Numbers = Callable[[Any], Sequence[Any]]  # of a sample


def refilled(message: Message, sources: Mapping[str, Callable[[Any], Any]]) -> Callable[[Any], bytes]:
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

    def fill(sample: Any) -> bytes:  # noqa: ANN401 - the kind of sample that the topic has
        nonlocal template
        try:
            numbers = [each(sample) for each in numbers_of]
        except (AttributeError, TypeError, ValueError) as error:
            if type(sample).__module__.startswith("harness.") or blamed(error):  # by what it says
                raise
            raise misfit(type(sample), sample, f"what a {kind_of(message)} holds") from error
        if template is None or not template.fits(numbers):
            for put, value_of in setters:
                put(value_of(sample))
            place_of = places(message, kind_of(message))
            template = Template(cdr(message), [place_of[path] for path in (*stamps, *sources)])
        return template.filled(numbers)

    return fill


def set_stamp(stamp: Message, stamp_ns: int) -> None:
    """Sets a builtin_interfaces/Time to nanoseconds of simulation time."""
    stamp.sec, stamp.nanosec = divmod(stamp_ns, NANOSECONDS)


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
    if isinstance(present, np.ndarray):
        return lambda value: setattr(owner, name, np.asarray(value, present.dtype))
    if hasattr(present, "x"):
        return partial(_set_axes, present)
    return lambda value: setattr(owner, name, type(present)(value))


def _set_axes(target: Message, value: Sequence[float]) -> None:
    for name, number in zip(AXES, value, strict=False):  # a vector has no w
        setattr(target, name, number)
