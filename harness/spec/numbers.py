"""Numbers as text has them: ASCII digits, a point, an exponent; not all that Python's float() takes."""

import re

NUMBER = re.compile(r"\s*[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf|nan)\s*", re.ASCII | re.IGNORECASE)


def number(text: str) -> float:
    """Returns the number that a text is.

    Raises:
        ValueError: It is none, as 1_000 and the digits of other scripts are.
    """
    if not NUMBER.fullmatch(text):
        raise ValueError(f"'{text}' is no number")
    return float(text)
