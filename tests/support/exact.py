"""Values as bytes, to compare them to the last bit: numpy tells of eight digits and takes longer."""

import io
import pickle


def as_bytes(value: object) -> bytes:
    """Returns the same for equal values, whatever in them is one object."""
    written = io.BytesIO()
    pickler = pickle.Pickler(written)
    pickler.fast = True
    pickler.dump(value)
    return written.getvalue()
