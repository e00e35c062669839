"""Numbers in texts of users and strangers, as everybody writes them: ASCII, without underscores."""

import re

FORM = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
NUMBER = re.compile(rf"{FORM}|[-+]?(?:inf|infinity|nan)", re.IGNORECASE)


def number(text: str) -> float:
    """Returns the number that a word is; ValueError if it is none, as of 1_000 and of other digits."""
    if not NUMBER.fullmatch(text.strip()):
        raise ValueError(f"'{text}' is no number")
    return float(text)


def whole(text: str) -> int:
    """Returns the whole number that a word is; ValueError if it is none, as of 1_000."""
    number(text)  # int() alone takes 1_000 and full-width digits
    return int(text)
